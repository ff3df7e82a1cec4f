#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/levelset/adapt.h"

namespace burnish {
namespace {

constexpr int kCorners = kBlockSide + 1;
constexpr std::size_t kOctantGrain = 8;

double lerp(double a, double b, double t) { return a + t * (b - a); }

// The trilinear interpolant of a field on the nodes of one octant, which need not be a leaf.
template <class T>
class OctantInterpolant {
 public:
  OctantInterpolant(const Octree& tree, const Field<T>& field, std::uint64_t key) : level_(morton::level(key)) {
    const morton::Position c = morton::corner(key);
    const auto at = [](std::uint32_t blocks) { return static_cast<std::int32_t>(blocks) * kBlockSide; };
    base_ = {at(c.x), at(c.y), at(c.z)};
    std::size_t n = 0;
    for (int k = 0; k < kCorners; ++k)
      for (int j = 0; j < kCorners; ++j)
        for (int i = 0; i < kCorners; ++i)
          values_[n++] = node_value(tree, field, {base_.x + (i << level_), base_.y + (j << level_), base_.z + (k << level_)});
  }

  double at(const LatticeNode& node) const {
    const std::array<std::int32_t, 3> from{node.x - base_.x, node.y - base_.y, node.z - base_.z};
    const double size = static_cast<double>(1 << level_);
    const auto t = [&](std::size_t a) { return static_cast<double>(from[a] & ((1 << level_) - 1)) / size; };
    const double* v = &values_[static_cast<std::size_t>((from[0] >> level_) + kCorners * ((from[1] >> level_) + kCorners * (from[2] >> level_)))];
    constexpr int dy = kCorners, dz = kCorners * kCorners;
    const auto plane = [&](const double* w) { return lerp(lerp(w[0], w[1], t(0)), lerp(w[dy], w[dy + 1], t(0)), t(1)); };
    return lerp(plane(v), plane(v + dz), t(2));
  }

 private:
  int level_;
  LatticeNode base_;
  std::array<double, kCorners * kCorners * kCorners> values_;
};

template <class T>
class Coarsening {
 public:
  Coarsening(const BasicLevelSet<T>& set, double tolerance, int coarsest_level, Progress& progress)
      : set_(set), tree_(set.octree()), tolerance_(tolerance), coarsest_(std::min(coarsest_level, tree_.depth())), progress_(progress) {}

  BasicLevelSet<T> run() {
    std::vector<std::uint64_t> keys = coarsest_octants();
    for (;;) {
      Octree tree = Octree::build_graded(tree_.depth(), keys);
      Field<T> phi = transfer_nodal(tree_, set_.phi, tree);
      const std::vector<std::uint64_t> failed = leaves_that_fail(tree, phi);
      if (failed.empty()) return {set_.frame, transfer_facets(set_.grid, std::move(tree)), std::move(phi), set_.band};
      for (const std::uint64_t key : failed) {
        const int l = morton::level(key);
        keys.push_back(morton::key((key >> (3 * l + 1)) << 3, l - 1));  // a child: so it is divided
      }
    }
  }

 private:
  // Whether `interpolant` reproduces every node of the old leaves in an octant. [T-ADAPT-3]
  bool reproduces(const OctantInterpolant<T>& interpolant, std::uint64_t key) const {
    const LeafRange range = leaves_in(tree_, key);
    for (std::size_t leaf = range.begin; leaf < range.end; ++leaf) {
      const T* values = set_.phi.block(leaf);
      for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
        const double old = values[n];
        const double now = interpolant.at(lattice_node(tree_, leaf, n % kBlockSide, n / kBlockSide % kBlockSide, n / (kBlockSide * kBlockSide)));
        const bool fine = std::abs(old) < set_.band ? std::abs(now - old) <= tolerance_ : (now >= 0) == (old >= 0);
        if (!fine) return false;
      }
    }
    return true;
  }

  // Octants that eight leaves, or octants merged before, can be merged into, by what the old octree's nodes say.
  std::vector<std::uint64_t> merged(const std::vector<std::uint64_t>& below) const {
    std::vector<std::uint64_t> parents;
    for (std::size_t i = 0; i + 7 < below.size(); ++i)
      if (morton::parent(below[i]) == morton::parent(below[i + 7])) parents.push_back(morton::parent(below[i]));
    std::vector<char> passes(parents.size());
    parallel_ranges(parents.size(), kOctantGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      for (std::size_t i = begin; i < end; ++i) passes[i] = reproduces(OctantInterpolant<T>(tree_, set_.phi, parents[i]), parents[i]);
    });
    std::vector<std::uint64_t> result;
    for (std::size_t i = 0; i < parents.size(); ++i)
      if (passes[i]) result.push_back(parents[i]);
    return result;
  }

  // Disjoint octants that cover the domain: leaves, and what they merge into.
  std::vector<std::uint64_t> coarsest_octants() const {
    std::vector<std::vector<std::uint64_t>> leaves(static_cast<std::size_t>(tree_.depth()) + 1);
    for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf) leaves[static_cast<std::size_t>(tree_.level(leaf))].push_back(tree_.key(leaf));
    std::vector<std::uint64_t> keys, here = leaves[0];
    for (int l = 0; l < tree_.depth(); ++l) {
      const std::vector<std::uint64_t> up = l < coarsest_ ? merged(here) : std::vector<std::uint64_t>{};
      for (const std::uint64_t key : here)
        if (!std::binary_search(up.begin(), up.end(), morton::parent(key))) keys.push_back(key);
      const std::vector<std::uint64_t>& old = leaves[static_cast<std::size_t>(l) + 1];
      here.clear();
      std::merge(up.begin(), up.end(), old.begin(), old.end(), std::back_inserter(here));
    }
    keys.insert(keys.end(), here.begin(), here.end());
    return keys;
  }

  // Merged leaves that do not reproduce the old nodes with the corners that they have now, some of them hanging.
  std::vector<std::uint64_t> leaves_that_fail(const Octree& tree, const Field<T>& phi) const {
    std::vector<char> fails(tree.size(), 0);
    parallel_ranges(tree.size(), kOctantGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      for (std::size_t leaf = begin; leaf < end; ++leaf) {
        const std::uint64_t key = tree.key(leaf);
        if (tree_.find_key(key) == Octree::kNone) fails[leaf] = !reproduces(OctantInterpolant<T>(tree, phi, key), key);
      }
    });
    std::vector<std::uint64_t> failed;
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
      if (fails[leaf]) failed.push_back(tree.key(leaf));
    return failed;
  }

  const BasicLevelSet<T>& set_;
  const Octree& tree_;
  const double tolerance_;
  const int coarsest_;
  Progress& progress_;
};

}  // namespace

template <class T>
BasicLevelSet<T> coarsen(const BasicLevelSet<T>& set, double tolerance, int coarsest_level, Progress& progress) {
  return Coarsening<T>(set, tolerance, coarsest_level, progress).run();
}

template BasicLevelSet<float> coarsen(const BasicLevelSet<float>&, double, int, Progress&);
template BasicLevelSet<double> coarsen(const BasicLevelSet<double>&, double, int, Progress&);

}  // namespace burnish
