#include "field_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/vdb.h"
#include "burnish/io/voxel_volume.h"

namespace burnish {
namespace {

constexpr std::size_t kManyCells = 50'000'000;  // from here on, their number is said before they are written
constexpr double kMargin = 0.05;               // of the longest side, around a model
constexpr double kMostSamples = 0x1p33, kMostAlong = 0x1p31;
constexpr std::size_t kGrain = 256;            // samples, and then blocks
constexpr double kHalfDiagonal = 0.8660254037844386 * kBlockSide;

float in_model_units(double phi, double cell, const std::optional<double>& clamp) {
  if (clamp) phi = std::clamp(phi, -*clamp, *clamp);
  return static_cast<float>(phi * cell);
}

// The blocks of finest cells in which a voxel may be nearer to the surface than the half width. [T-EXPORT-3]
class BandBlocks {
 public:
  using Corner = std::array<std::int32_t, 3>;

  BandBlocks(const LevelSet& set, double half_width) : set_(set), half_width_(half_width) {
    const Octree& tree = set.octree();
    first_.assign(tree.size() + 1, 0);
    parallel_for(tree.size(), [&](std::size_t leaf) { visit(leaf, [&](const Corner&) { ++first_[leaf + 1]; }); }, 16);
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
  }

  std::size_t count() const { return first_.back(); }
  std::vector<Corner> corners() const {
    std::vector<Corner> all(count());
    parallel_for(first_.size() - 1, [&](std::size_t leaf) { visit(leaf, [&, next = first_[leaf]](const Corner& c) mutable { all[next++] = c; }); }, 16);
    return all;
  }

 private:
  // Distances differ by no more than points do; the cell more is for what interpolation is off in coarse cells.
  template <class Found>
  void divide(const Corner& corner, int level, Found& found) const {
    const std::int32_t half = (kBlockSide / 2) << level;
    const double phi = node_value(set_.octree(), set_.phi, {corner[0] + half, corner[1] + half, corner[2] + half});
    if (std::abs(phi) > half_width_ + (kHalfDiagonal + 1) * (1 << level)) return;
    if (level == 0) return found(corner);
    for (int child = 0; child < 8; ++child) {
      Corner at = corner;
      for (std::size_t a = 0; a < 3; ++a) at[a] += (child >> a & 1) * half;
      divide(at, level - 1, found);
    }
  }

  template <class Found>
  void visit(std::size_t leaf, Found found) const {
    const LatticeNode corner = lattice_node(set_.octree(), leaf, 0, 0, 0);
    divide({corner.x, corner.y, corner.z}, set_.octree().level(leaf), found);
  }

  const LevelSet& set_;
  double half_width_;
  std::vector<std::size_t> first_;  // number of each leaf's first block, and the count
};

// Samples at the nodes of a block of finest cells: those that are stored, or between them.
void sample_block(const LevelSet& set, const FieldSamples& samples, const std::array<std::int32_t, 3>& corner, std::span<float> phi) {
  const Octree& tree = set.octree();
  const auto block = [&](std::size_t a) { return static_cast<std::uint32_t>(corner[a]) / kBlockSide; };
  const std::uint32_t leaf = tree.find({block(0), block(1), block(2)});
  if (tree.level(leaf) == 0) {
    const float* stored = set.phi.block(leaf);
    std::transform(stored, stored + kBlockNodes, phi.begin(), [&](float v) { return in_model_units(static_cast<double>(v), set.frame.cell, {}); });
    return;
  }
  std::vector<Vec3> points(phi.size());
  std::vector<double> values(phi.size());
  for (int n = 0; n < static_cast<int>(points.size()); ++n) {
    const int i = n % kBlockSide, j = n / kBlockSide % kBlockSide, k = n / kBlockSide / kBlockSide;
    points[static_cast<std::size_t>(n)] = {static_cast<double>(corner[0] + i), static_cast<double>(corner[1] + j), static_cast<double>(corner[2] + k)};
  }
  samples.at(points, values.data());
  std::transform(values.begin(), values.end(), phi.begin(), [&](double v) { return in_model_units(v, set.frame.cell, {}); });
}

}  // namespace

SampleGrid sample_grid(const FieldContent& content, const Box3& model, double cell) {
  Box3 box = content.box.value_or(model);
  const double margin = content.box ? 0 : kMargin * model.longest_side();
  box.lower -= Vec3{margin, margin, margin}, box.upper += Vec3{margin, margin, margin};
  SampleGrid grid{{}, box.lower, cell};
  if (content.samples) grid.spacing = box.longest_side() / (*content.samples - 1);
  if (content.spacing) grid.spacing = content.spacing->in_model_units(model.diagonal(), cell);
  if (!(grid.spacing > 0)) throw Error(ErrorCode::usage, fmt::format("expected a spacing greater than zero, found {:g}", grid.spacing), "give a box that has a size, and a spacing above zero");
  double all = 1;
  for (int a = 0; a < 3; ++a) {
    const double steps = std::ceil((box.upper[a] - box.lower[a]) / grid.spacing * (1 - 1e-9));
    all *= steps + 1;
    if (all > kMostSamples || steps >= kMostAlong)
      throw Error(ErrorCode::memory_limit, fmt::format("a spacing of {:.4g} makes more than {:.3g} samples", grid.spacing, kMostSamples), "choose a larger --spacing, fewer --samples, or a smaller --box");
    grid.nodes[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(steps) + 1;
  }
  return grid;
}

FieldOutput::FieldOutput(const std::string& path, bool overwrite) {
  told_.file = path;
  if (path.empty()) return;
  format_ = field_format_for_writing(path);
  told_.format = name(format_);
  file_.emplace(path, overwrite);
}

void FieldOutput::refuse_beyond(std::uint64_t budget, std::uint64_t needed, const std::string& what, const std::string& hint) const {
  if (needed <= budget) return;
  throw Error(ErrorCode::memory_limit,
              fmt::format("{}: writing {} takes about {:.1f} GB; the budget is {:.1f} GB", told_.file, what, static_cast<double>(needed) * 0x1p-30, static_cast<double>(budget) * 0x1p-30), hint);
}

void FieldOutput::require_memory(std::size_t cells, std::uint64_t held, std::uint64_t budget, const std::string& hint) const {
  refuse_beyond(budget, held + bytes_to_write_field(cells, format_), fmt::format("{} cells", cells), hint);
}

void FieldOutput::require_memory(const SampleGrid& grid, std::uint64_t held, std::uint64_t budget) const {
  const std::uint64_t layer = std::uint64_t{grid.nodes[0]} * grid.nodes[1];
  refuse_beyond(budget, held + bytes_to_write_voxels(grid.nodes), fmt::format("layers of {} samples", layer), "choose a larger --spacing, fewer --samples, or a smaller --box, or raise --memory");
}

std::string FieldOutput::stage(std::size_t count, const char* what) {
  return count > kManyCells ? fmt::format("writing {} million {}", count / 1'000'000, what) : "writing";
}

void FieldOutput::commit() {
  told_.bytes = file_->bytes();
  file_->commit();
  told_.written = true;
}

void FieldOutput::write(const CellGrid& grid, Progress& progress) {
  const WrittenField written = write_field(file_->fd(), file_->destination(), grid, format_, progress);
  commit();
  told_.cell_count = written.cells;
  told_.point_count = written.points;
  told_.octant_count = written.octants;
}

void FieldOutput::write(const SampleGrid& grid, const FieldSamples& samples, const GridFrame& frame, const std::optional<double>& clamp, Progress& progress) {
  const std::size_t row = grid.nodes[0], layer = row * grid.nodes[1];
  VoxelSource source{grid.nodes, grid.origin, {grid.spacing, grid.spacing, grid.spacing}, "phi", {}};
  source.fill = [&](std::uint32_t first, std::uint32_t last, std::span<float> values) {
    parallel_ranges(layer * (last - first), kGrain, [&](std::size_t begin, std::size_t end) {
      progress.check();
      std::array<Vec3, kGrain> points;
      std::array<double, kGrain> phi;
      for (std::size_t n = begin; n < end; ++n) {
        const std::size_t i = n % row, j = n % layer / row, k = first + n / layer;
        const Vec3 node{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        points[n - begin] = frame.to_lattice(grid.origin + node * grid.spacing);
      }
      samples.at({points.data(), end - begin}, phi.data());
      for (std::size_t n = begin; n < end; ++n) values[n] = in_model_units(phi[n - begin], frame.cell, clamp);
    });
  };
  write_voxels(file_->fd(), file_->destination(), source, format_ == FieldFormat::vti ? VoxelFormat::vti : VoxelFormat::nrrd, progress);
  commit();
  told_.samples = grid.nodes;
  told_.spacing = grid.spacing;
}

void FieldOutput::write(const LevelSet& set, const FieldSamples& samples, double half_width, std::uint64_t held, std::uint64_t budget, Progress& progress) {
  const BandBlocks blocks(set, half_width);
  refuse_beyond(budget, held + blocks.count() * kVdbBytesPerBlock, fmt::format("{} blocks of voxels", blocks.count()), "choose a smaller --narrow-band or a larger --cell, or raise --memory");
  VdbSource source{set.frame.origin, set.frame.cell, half_width, "surface", blocks.corners(), {}};
  source.fill = [&](std::size_t block, std::span<float> phi) { sample_block(set, samples, source.blocks[block], phi); };
  told_.voxel_count = write_vdb(file_->fd(), file_->destination(), source, progress).active_voxels;
  commit();
  told_.spacing = set.frame.cell;
}

}  // namespace burnish
