#include "burnish/levelset/verify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/distance.h"
#include "burnish/surface/exact_distance.h"

namespace burnish {
namespace {

constexpr double kRelative = 1e-9, kOfDiagonal = 1e-12;  // allowed errors
constexpr std::size_t kLeastPerLeaf = 2;                 // nodes that a leaf gives to each stratum
constexpr double kSpare = 4;                             // times what leaves would give if each had every stratum
constexpr std::size_t kLeavesAtOnce = 64;

struct Candidate {
  LatticeNode node;
  double distance = 0;  // the kernel's
  double band = 0;      // of the node's leaf
  double stored = 0;    // |phi|
  bool is_exact = true; // should be
  NodeStratum stratum = NodeStratum::near_surface;
};

// std::uniform_int_distribution is not the same everywhere.
std::size_t below(std::mt19937_64& random, std::size_t n) { return static_cast<std::size_t>(random() % n); }

std::vector<std::uint32_t> shuffled_near_leaves(const SurfaceOctree& grid, std::uint64_t seed) {
  std::vector<std::uint32_t> leaves;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf)
    if (grid.near_surface(leaf)) leaves.push_back(static_cast<std::uint32_t>(leaf));
  std::mt19937_64 random(seed);
  for (std::size_t i = leaves.size(); i > 1; --i) std::swap(leaves[i - 1], leaves[below(random, i)]);
  return leaves;
}

// Both in cells of the leaf's level.
NodeStratum stratum_of(double distance, double band) {
  return distance < 1 ? NodeStratum::near_surface : distance < band - 1 ? NodeStratum::mid_band : NodeStratum::band_edge;
}

// One leaf's nodes, and those that are taken of them.
class LeafSample {
 public:
  LeafSample(const TriangleSoup& soup, const std::vector<char>& active, const LevelSet& set, std::size_t leaf, const DistanceCheckOptions& options)
      : soup_(soup), active_(active), set_(set), exact_(options.exact), leaf_(leaf), side_(1 << set.octree().level(leaf)),
        random_(options.seed ^ (leaf + 1) * 0x9e3779b97f4a7c15ull), squared_(kBlockNodes) {
    std::vector<std::uint32_t> nearest(kBlockNodes);
    exact_squared_distances(soup, set.grid, leaf, set.band, active, squared_.data(), nearest.data());
  }

  // Up to so many nodes of each stratum, none of them twice.
  std::vector<Candidate> take(std::size_t most) {
    std::array<std::vector<std::size_t>, kNodeStrata> nodes;
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      nodes[static_cast<std::size_t>(stratum_of(std::sqrt(squared_[n]) / side_, set_.band))].push_back(n);
    nodes[static_cast<std::size_t>(NodeStratum::near_features)] = nodes_at_features();
    std::vector<Candidate> taken;
    for (std::size_t s = 0; s < kNodeStrata; ++s)
      for (std::size_t i = 0; i < std::min(most, nodes[s].size()); ++i) {
        std::swap(nodes[s][i], nodes[s][i + below(random_, nodes[s].size() - i)]);
        taken.push_back(candidate(nodes[s][i], static_cast<NodeStratum>(s)));
      }
    return taken;
  }

 private:
  Candidate candidate(std::size_t n, NodeStratum stratum) const {
    const auto i = static_cast<int>(n);
    return {lattice_node(set_.octree(), leaf_, i % kBlockSide, i / kBlockSide % kBlockSide, i / (kBlockSide * kBlockSide)), std::sqrt(squared_[n]),
            set_.band * side_, std::abs(static_cast<double>(set_.phi.block(leaf_)[n])), exact_ == nullptr || exact_->block(leaf_)[n] != 0, stratum};
  }

  // Of a few of the leaf's facets the nodes nearest to corners and to middles of edges.
  std::vector<std::size_t> nodes_at_features() {
    const auto facets = set_.grid.facets_of(leaf_);
    std::vector<std::size_t> nodes;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::uint32_t f = facets[below(random_, facets.size())];
      if (!active_[f]) continue;
      for (int c = 0; c < 3; ++c) {
        const Vec3 &a = soup_.corner(f, c), &b = soup_.corner(f, (c + 1) % 3);
        for (const Vec3& at : {a, (a + b) * 0.5}) add_nearest(at, nodes);
      }
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }

  void add_nearest(const Vec3& at, std::vector<std::size_t>& nodes) const {
    const LatticeNode corner = lattice_node(set_.octree(), leaf_, 0, 0, 0);
    const double x = std::round((at.x - corner.x) / side_), y = std::round((at.y - corner.y) / side_), z = std::round((at.z - corner.z) / side_);
    const auto is_own = [](double c) { return c >= 0 && c < kBlockSide; };
    if (is_own(x) && is_own(y) && is_own(z)) nodes.push_back(node_index(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)));
  }

  const TriangleSoup& soup_;
  const std::vector<char>& active_;
  const LevelSet& set_;
  const Field<std::uint8_t>* exact_;
  const std::size_t leaf_;
  const double side_;  // of its cells
  std::mt19937_64 random_;
  std::vector<double> squared_;
};

// Leaves in random order, until every stratum has its part or there are no leaves left.
std::vector<Candidate> choose_nodes(const TriangleSoup& soup, const std::vector<char>& active, const LevelSet& set,
                                    const DistanceCheckOptions& options, Progress& progress) {
  const std::vector<std::uint32_t> leaves = shuffled_near_leaves(set.grid, options.seed);
  const std::size_t part = (options.nodes + kNodeStrata - 1) / kNodeStrata;
  const double per_leaf = kSpare * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(1, leaves.size()));
  const std::size_t most = std::max(kLeastPerLeaf, static_cast<std::size_t>(std::ceil(per_leaf)));
  std::array<std::size_t, kNodeStrata> counts{};
  std::vector<Candidate> chosen;
  const auto is_lacking = [&](std::size_t count) { return count < part; };
  for (std::size_t first = 0; first < leaves.size() && std::ranges::any_of(counts, is_lacking); first += kLeavesAtOnce) {
    progress.check();
    std::vector<std::vector<Candidate>> found(std::min(kLeavesAtOnce, leaves.size() - first));
    parallel_for(found.size(), [&](std::size_t i) { found[i] = LeafSample(soup, active, set, leaves[first + i], options).take(most); }, 1);
    for (const auto& of_leaf : found)
      for (const Candidate& c : of_leaf)
        if (counts[static_cast<std::size_t>(c.stratum)]++ < part) chosen.push_back(c);
  }
  return chosen;
}

void add(ErrorSummary& sum, double error, double allowed) {
  sum.max = std::max(sum.max, error);
  sum.rms += error * error;
  sum.worst_share = std::max(sum.worst_share, error / allowed);
  sum.exceeded += !(error <= allowed);
}

void finish(ErrorSummary& sum, std::size_t nodes) { sum.rms = nodes > 0 ? std::sqrt(sum.rms / static_cast<double>(nodes)) : 0; }

}  // namespace

std::string_view name(NodeStratum stratum) {
  constexpr std::array<std::string_view, kNodeStrata> kNames{"near_surface", "mid_band", "band_edge", "near_features"};
  return kNames[static_cast<std::size_t>(stratum)];
}

std::size_t DistanceCheck::total() const { return std::accumulate(nodes.begin(), nodes.end(), std::size_t{0}); }

DistanceCheck check_distances(const TriangleSoup& lattice_soup, const std::vector<FacetRole>& roles, const LevelSet& level_set,
                              const DistanceCheckOptions& options, Progress& progress) {
  TriangleSoup surface{lattice_soup.points, {}, {}};
  std::vector<char> active(roles.size());
  for (std::size_t f = 0; f < roles.size(); ++f) {
    active[f] = roles[f] == FacetRole::boundary;
    if (active[f]) surface.facets.push_back(lattice_soup.facets[f]);
  }
  const std::vector<Candidate> chosen = choose_nodes(lattice_soup, active, level_set, options, progress);
  const ExactDistance reference(surface);
  std::vector<double> exact(chosen.size());
  parallel_ranges(chosen.size(), 16, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t i = begin; i < end; ++i) {
      const LatticeNode& n = chosen[i].node;
      exact[i] = std::sqrt(reference.squared_distance({static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)}));
    }
  });
  DistanceCheck check;
  constexpr double kHalfUnit = 0.5 * std::numeric_limits<float>::epsilon();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Candidate& c = chosen[i];
    const double allowed = kRelative * exact[i] + kOfDiagonal * options.diagonal;
    ++check.nodes[static_cast<std::size_t>(c.stratum)];
    add(check.kernel, std::abs(c.distance - std::min(exact[i], c.band)), allowed);
    if (!(c.distance < c.band && c.is_exact)) continue;
    ++check.stored_nodes;
    add(check.stored, std::abs(c.stored - exact[i]), allowed + kHalfUnit * exact[i]);
  }
  finish(check.kernel, check.total());
  finish(check.stored, check.stored_nodes);
  return check;
}

}  // namespace burnish
