#include "burnish/levelset/from_voxels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/levelset/redistance.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 18;  // values looked at by one thread
constexpr std::size_t kClasses = 4096;                // of a histogram
constexpr double kMargin = 11;                        // cells between what is stored and the walls
constexpr double kSameSpacing = 1e-3;                 // cells by which unequal spacings may drift apart over the whole volume
constexpr double kBytesPerBlock = 10'000;              // near the surface: values, lists, and what redistancing holds
constexpr std::size_t kBatch = std::size_t{1} << 16;   // blocks looked at between two looks at the budget
constexpr float kLeastPhi = 1e-6f;                    // cells
constexpr int kSide = kBlockSide + 1;                 // nodes along the edge of a block's cells

// Where a lattice coordinate lies between the voxels of an axis.
struct AxisNode {
  std::uint32_t voxel = 0;  // the one at or below
  double weight = 0;        // of the next one
  double keep = 1;          // of a value inside: falls from 1 at the border to -1 a spacing beyond
};

// The voxels' values on the lattice: positive inside, less the iso value.
class LatticeValues {
 public:
  LatticeValues(const VoxelSamples& samples, double iso, bool inside_above, double cell, int margin)
      : samples_(samples), iso_(iso), sign_(inside_above ? 1 : -1) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t n = samples.nodes[static_cast<std::size_t>(axis)];
      double step = cell / samples.spacing[axis];  // a lattice step, in voxels
      if (std::abs(step - 1) * static_cast<double>(n) < kSameSpacing) step = 1;
      const auto last = static_cast<int>(std::ceil(static_cast<double>(n - 1) / step - 1e-9));
      first_[static_cast<std::size_t>(axis)] = margin - outside(step);
      auto& nodes = nodes_[static_cast<std::size_t>(axis)];
      for (int i = -outside(step); i <= last + outside(step); ++i) nodes.push_back(node_at(i * step, n));
    }
  }

  // The lattice coordinates, along an axis, between which values vary; beyond they are those of the ends.
  std::array<int, 2> extent(std::size_t axis) const { return {first_[axis], first_[axis] + static_cast<int>(nodes_[axis].size()) - 1}; }

  // Whether the cells of a block lie between voxels that are all on one side, as most of a volume does: then so are their nodes, which are means of these.
  // Beyond the border nothing is inside, so that what is outside there stays so.
  bool is_plainly_on_one_side(const std::array<int, 3>& block) const {
    std::array<std::size_t, 3> low, count;
    bool is_within = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const AxisNode &from = node(a, kBlockSide * block[a]), &to = node(a, kBlockSide * block[a] + kBlockSide);
      is_within = is_within && from.keep >= 1 && to.keep >= 1;
      low[a] = from.voxel;
      count[a] = to.voxel + (to.weight > 0) + 1 - from.voxel;
    }
    const auto is_inside = [&](float value) { return sign_ * (static_cast<double>(value) - iso_) > 0; };
    const std::size_t row = samples_.nodes[0], layer = row * samples_.nodes[1];
    const float* const first = samples_.values.data() + low[0] + row * low[1] + layer * low[2];
    std::size_t inside = 0, seen = 0;
    for (std::size_t k = 0; k < count[2]; ++k)
      for (std::size_t j = 0; j < count[1]; ++j) {
        const float* const at = first + row * j + layer * k;
        for (std::size_t i = 0; i < count[0]; ++i) inside += is_inside(at[i]);
        seen += count[0];
        if (inside != 0 && (inside != seen || !is_within)) return false;
      }
    return true;
  }

  // Never 0.
  double operator()(const std::array<int, 3>& at) const {
    const AxisNode &x = node(0, at[0]), &y = node(1, at[1]), &z = node(2, at[2]);
    const double value = sign_ * interpolated(x, y, z), keep = std::min({x.keep, y.keep, z.keep});
    if (!(value > 0)) return value < 0 ? value : -std::numeric_limits<double>::min();
    return keep > 0 ? value * keep : keep < 0 ? value * keep : -std::numeric_limits<double>::min();  // [T-VOXEL-2]
  }

 private:
  // Lattice nodes up to a spacing beyond the border.
  static int outside(double step) { return static_cast<int>(std::ceil(1 / step)) + 1; }

  static AxisNode node_at(double place, std::size_t n) {
    const double last = static_cast<double>(n - 1), inside = std::clamp(place, 0.0, last), nearest = std::round(inside);
    const double beyond = std::max(-place, place - last);
    AxisNode node;
    node.voxel = static_cast<std::uint32_t>(std::abs(inside - nearest) < 1e-9 ? nearest : std::floor(inside));
    node.weight = inside - static_cast<double>(node.voxel) < 1e-9 ? 0 : inside - static_cast<double>(node.voxel);
    node.keep = beyond > 1e-9 ? std::max(-1.0, 1 - 2 * beyond) : 1;
    return node;
  }

  const AxisNode& node(std::size_t axis, int at) const {
    return nodes_[axis][static_cast<std::size_t>(std::clamp(at - first_[axis], 0, static_cast<int>(nodes_[axis].size()) - 1))];
  }

  // Less the iso value: of differences, whose mean has their sign if they have the same.
  double interpolated(const AxisNode& x, const AxisNode& y, const AxisNode& z) const {
    const std::size_t row = samples_.nodes[0], layer = row * samples_.nodes[1];
    const float* at = samples_.values.data() + x.voxel + row * y.voxel + layer * z.voxel;
    if (x.weight + y.weight + z.weight == 0) return static_cast<double>(*at) - iso_;
    double sum = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      const double weight = (c & 1 ? x.weight : 1 - x.weight) * (c & 2 ? y.weight : 1 - y.weight) * (c & 4 ? z.weight : 1 - z.weight);
      if (weight > 0) sum += weight * (static_cast<double>(at[(c & 1) + (c & 2 ? row : 0) + (c & 4 ? layer : 0)]) - iso_);
    }
    return sum;
  }

  const VoxelSamples& samples_;
  double iso_, sign_;
  std::array<std::vector<AxisNode>, 3> nodes_;
  std::array<int, 3> first_{};
};

// The cells of a block that the surface cuts.
struct CutCells {
  std::array<std::int8_t, 3> low{kBlockSide, kBlockSide, kBlockSide}, high{-1, -1, -1};
  std::uint16_t edges = 0;  // along the axes, with ends on both sides
  double jump = 0;          // sum over these of the difference between their ends

  bool any() const { return high[0] >= 0; }
  void add(int i, int j, int k) {
    const std::array<int, 3> cell{i, j, k};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], static_cast<std::int8_t>(cell[a]));
      high[a] = std::max(high[a], static_cast<std::int8_t>(cell[a]));
    }
  }
};

// A box of blocks, numbered with x fastest.
struct BlockBox {
  std::array<int, 3> low{}, sides{};

  std::size_t size() const { return static_cast<std::size_t>(sides[0]) * static_cast<std::size_t>(sides[1]) * static_cast<std::size_t>(sides[2]); }
  std::array<int, 3> block(std::size_t n) const {
    const auto x = static_cast<std::size_t>(sides[0]), y = static_cast<std::size_t>(sides[1]);
    return {low[0] + static_cast<int>(n % x), low[1] + static_cast<int>(n / x % y), low[2] + static_cast<int>(n / x / y)};
  }
  std::size_t number(const std::array<int, 3>& b) const {
    return static_cast<std::size_t>(b[0] - low[0]) + static_cast<std::size_t>(sides[0]) * (static_cast<std::size_t>(b[1] - low[1]) + static_cast<std::size_t>(sides[1]) * static_cast<std::size_t>(b[2] - low[2]));
  }
  BlockBox grown(int rings) const { return {{low[0] - rings, low[1] - rings, low[2] - rings}, {sides[0] + 2 * rings, sides[1] + 2 * rings, sides[2] + 2 * rings}}; }
};

CutCells cut_cells_of(const LatticeValues& values, const std::array<int, 3>& block) {
  if (values.is_plainly_on_one_side(block)) return {};
  std::array<double, kSide * kSide * kSide> dense;
  bool in = false, out = false;
  for (int k = 0, n = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i, ++n) {
        const double value = dense[static_cast<std::size_t>(n)] = values({kBlockSide * block[0] + i, kBlockSide * block[1] + j, kBlockSide * block[2] + k});
        (value > 0 ? in : out) = true;
      }
  CutCells cut;
  if (!in || !out) return cut;
  constexpr std::array<std::size_t, 3> kSteps{1, kSide, kSide * kSide};
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j)
      for (int i = 0; i < kBlockSide; ++i) {
        const double* at = dense.data() + i + kSide * (j + kSide * k);
        int inside = 0;
        for (std::size_t c = 0; c < 8; ++c) inside += at[(c & 1 ? kSteps[0] : 0) + (c & 2 ? kSteps[1] : 0) + (c & 4 ? kSteps[2] : 0)] > 0;
        if (inside == 0 || inside == 8) continue;
        cut.add(i, j, k);
        for (const std::size_t step : kSteps)
          if ((at[0] > 0) != (at[step] > 0)) ++cut.edges, cut.jump += std::abs(at[0] - at[step]);
      }
  return cut;
}

// Marks the blocks with a node within `reach` of a cut cell's box.
std::vector<std::uint64_t> blocks_near(const std::vector<CutCells>& cuts, const BlockBox& box, double reach) {
  const int rings = static_cast<int>(std::ceil((reach + 1) / kBlockSide));
  const BlockBox around = box.grown(rings);
  std::vector<char> is_near(around.size(), 0);
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    if (!cuts[n].any()) continue;
    const std::array<int, 3> b = box.block(n);
    const auto gap = [&](std::size_t axis, int offset) {  // in nodes, from the cut cells to those of a block so many blocks away
      return std::max({0, kBlockSide * offset - (cuts[n].high[axis] + 1), cuts[n].low[axis] - (kBlockSide * offset + kBlockSide - 1)});
    };
    for (int z = -rings; z <= rings; ++z)
      for (int y = -rings; y <= rings; ++y)
        for (int x = -rings; x <= rings; ++x)
          if (std::hypot(gap(0, x), gap(1, y), gap(2, z)) <= reach) is_near[around.number({b[0] + x, b[1] + y, b[2] + z})] = 1;
  }
  std::vector<std::uint64_t> near;
  for (std::size_t n = 0; n < is_near.size(); ++n)
    if (is_near[n]) {
      const std::array<int, 3> b = around.block(n);
      near.push_back(morton::interleave({static_cast<std::uint32_t>(b[0]), static_cast<std::uint32_t>(b[1]), static_cast<std::uint32_t>(b[2])}));
    }
  parallel_sort(near);
  return near;
}

// The frame whose lattice node (margin, margin, margin) is the first voxel.
GridFrame frame_of(const VoxelSamples& samples, double cell, int margin) {
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, (samples.nodes[static_cast<std::size_t>(axis)] - 1) * samples.spacing[axis] / cell);
  GridFrame frame{samples.origin - Vec3{1, 1, 1} * (margin * cell), cell, 0};
  while (frame.lattice_side() < longest + 2 * margin + 1) {
    if (frame.depth == morton::kMaxDepth)
      throw Error(ErrorCode::memory_limit, fmt::format("the volume is {:.3g} cells long; {:.0f} are possible", longest, frame.lattice_side()), "crop it, or resample it with other spacings");
    ++frame.depth;
  }
  return frame;
}

// What there would be along the other axes' voxels is one lattice node: unequal spacings can make very many.
void require_memory(double bytes, std::uint64_t budget, const VoxelSamples& samples) {
  if (bytes <= static_cast<double>(budget)) return;
  const auto& [x, y, z] = samples.spacing;
  throw Error(ErrorCode::memory_limit,
              fmt::format("a level set with cells of {:.4g}, the least of the spacings {:.4g}, {:.4g}, {:.4g}, takes at least {:.1f} GB; the budget is {:.1f} GB", cell_of(samples), x, y, z,
                          bytes * 0x1p-30, static_cast<double>(budget) * 0x1p-30),
              "resample the volume with spacings that are alike, crop it, or raise --memory");
}

SurfaceOctree octree_of(int depth, const std::vector<std::uint64_t>& finest) {
  SurfaceOctree grid;
  grid.octree = Octree::build(depth, finest);
  grid.first_facet.assign(grid.octree.size() + 1, 0);
  auto next = finest.begin();
  grid.layout = layout_of(grid.octree.size(), [&](std::size_t leaf) {
    if (next == finest.end() || morton::key(*next, 0) != grid.octree.key(leaf)) return false;
    ++next;
    return true;
  });
  return grid;
}

// The values in units of `per_cell`, on the side they are on. [T-VOXEL-1]
Field<float> scaled_values(const LatticeValues& values, const SurfaceOctree& grid, double per_cell, float band) {
  Field<float> phi(grid.layout, band, -band);
  parallel_for(grid.octree.size(), [&](std::size_t leaf) {
    const LatticeNode corner = lattice_node(grid.octree, leaf, 0, 0, 0);
    if (!phi.stores(leaf)) return phi.set_uniform(leaf, !(values({corner.x, corner.y, corner.z}) > 0));
    float* block = phi.block(leaf);
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i) {
          const double value = values({corner.x + i, corner.y + j, corner.z + k});
          const auto scaled = static_cast<float>(value / per_cell);
          block[node_index(i, j, k)] = value > 0 ? std::max(scaled, kLeastPhi) : std::min(scaled, -kLeastPhi);
        }
  }, 16);
  return phi;
}

std::size_t border_voxels_inside(const VoxelSamples& samples, double iso, bool inside_above) {
  const auto [nx, ny, nz] = samples.nodes;
  const auto is_border = [](std::size_t i, std::uint32_t n) { return i == 0 || i + 1 == n; };
  return parallel_reduce(
      std::size_t{ny} * nz, 256, std::size_t{0},
      [&, nx = nx, ny = ny, nz = nz](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t row = begin; row < end; ++row) {
          const bool whole = is_border(row % ny, ny) || is_border(row / ny, nz);
          for (std::size_t i = 0; i < nx; i += whole || nx == 1 ? 1 : nx - 1) {
            const auto value = static_cast<double>(samples.values[row * nx + i]);
            count += inside_above ? value > iso : value < iso;
          }
        }
        return count;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

}  // namespace

double cell_of(const VoxelSamples& samples) { return std::min({samples.spacing.x, samples.spacing.y, samples.spacing.z}); }

ValueRange value_range(const VoxelSamples& samples) {
  if (samples.values.empty()) throw Error(ErrorCode::unreadable_input, "the volume has no values", "it takes one for each node");
  const std::span<const float> values = samples.values;
  struct Found {
    ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    std::size_t bad = std::numeric_limits<std::size_t>::max();
  };
  const Found found = parallel_reduce(
      values.size(), kGrain, Found{},
      [&](std::size_t begin, std::size_t end) {
        Found part;
        for (std::size_t i = begin; i < end; ++i) {
          const auto value = static_cast<double>(values[i]);
          if (!std::isfinite(value)) return Found{{}, i};
          part.range = {std::min(part.range.least, value), std::max(part.range.most, value)};
        }
        return part;
      },
      [](const Found& a, const Found& b) {
        return Found{{std::min(a.range.least, b.range.least), std::max(a.range.most, b.range.most)}, std::min(a.bad, b.bad)};
      });
  if (found.bad == Found{}.bad) return found.range;
  const std::size_t row = samples.nodes[0], layer = row * samples.nodes[1];
  throw Error(ErrorCode::unreadable_input,
              fmt::format("the value of voxel ({}, {}, {}) is {}: expected a finite number", found.bad % row, found.bad / row % samples.nodes[1], found.bad / layer, values[found.bad]),
              "replace such values by one that is outside, in the tool that made the volume");
}

bool has_two_values(const VoxelSamples& samples, const ValueRange& range) {
  const auto least = static_cast<float>(range.least), most = static_cast<float>(range.most);
  return least < most && std::all_of(samples.values.begin(), samples.values.end(), [&](float v) { return v == least || v == most; });
}

double otsu_threshold(const VoxelSamples& samples, const ValueRange& range) {
  const double width = (range.most - range.least) / static_cast<double>(kClasses);
  if (!(width > 0)) return range.least;
  using Histogram = std::vector<std::uint64_t>;
  const Histogram histogram = parallel_reduce(
      samples.values.size(), 64 * kGrain, Histogram(kClasses, 0),
      [&](std::size_t begin, std::size_t end) {
        Histogram part(kClasses, 0);
        for (std::size_t i = begin; i < end; ++i) ++part[std::min(kClasses - 1, static_cast<std::size_t>((static_cast<double>(samples.values[i]) - range.least) / width))];
        return part;
      },
      [](Histogram a, const Histogram& b) {
        for (std::size_t c = 0; c < kClasses; ++c) a[c] += b[c];
        return a;
      });
  double total = 0, moment = 0;
  for (std::size_t c = 0; c < kClasses; ++c) total += static_cast<double>(histogram[c]), moment += static_cast<double>(c) * static_cast<double>(histogram[c]);
  // The classes' variance is least where that between them is greatest. [T-VOXEL-3]
  double best = -1, below = 0, below_moment = 0, first = 0, last = 0;
  for (std::size_t c = 0; c + 1 < kClasses; ++c) {
    below += static_cast<double>(histogram[c]);
    below_moment += static_cast<double>(c) * static_cast<double>(histogram[c]);
    const double difference = below_moment * total - moment * below, between = difference * difference / (below * (total - below));
    if (between > best) best = between, first = static_cast<double>(c + 1);
    if (between >= best) last = static_cast<double>(c + 1);
  }
  return range.least + 0.5 * (first + last) * width;
}

LevelSetFromVoxels level_set_from_voxels(const VoxelSamples& samples, double iso, bool inside_above, const VoxelLevelSetOptions& options, Progress& progress) {
  const double cell = cell_of(samples), reach = options.band + options.room;
  const int margin = static_cast<int>(std::ceil(reach + kMargin)) + kBlockSide;
  LevelSetFromVoxels result;
  LevelSet& set = result.level_set;
  set.frame = frame_of(samples, cell, margin);
  set.band = options.band;
  const LatticeValues values(samples, iso, inside_above, cell, margin);
  BlockBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = values.extent(a);
    box.low[a] = low / kBlockSide;
    box.sides[a] = high / kBlockSide - box.low[a] + 1;
  }
  require_memory(static_cast<double>(box.size()) * sizeof(CutCells), options.memory_bytes, samples);
  std::vector<CutCells> cuts(box.size());
  double cut_blocks = 0;
  for (std::size_t first = 0; first < cuts.size(); first += kBatch) {
    const std::size_t last = std::min(cuts.size(), first + kBatch);
    parallel_for(last - first, [&](std::size_t n) {
      if (n % 64 == 0) progress.check();
      cuts[first + n] = cut_cells_of(values, box.block(first + n));
    }, 64);
    for (std::size_t n = first; n < last; ++n) cut_blocks += cuts[n].any();
    require_memory(cut_blocks * kBytesPerBlock, options.memory_bytes, samples);
  }
  double jump = 0, edges = 0;
  for (const CutCells& cut : cuts) jump += cut.jump, edges += cut.edges;
  if (edges == 0)
    throw Error(ErrorCode::guarantee_unmet, fmt::format("no voxel is {} {}: there is no surface", inside_above ? "above" : "below", iso), "choose another --iso");
  const std::vector<std::uint64_t> near = blocks_near(cuts, box, reach);
  require_memory(static_cast<double>(near.size()) * kBytesPerBlock, options.memory_bytes, samples);
  set.grid = octree_of(set.frame.depth, near);
  set.phi = scaled_values(values, set.grid, jump / edges, static_cast<float>(options.band));
  redistance(set, options.band, progress);
  result.border_voxels = border_voxels_inside(samples, iso, inside_above);
  return result;
}

}  // namespace burnish
