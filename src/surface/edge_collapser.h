// One run of edge collapses in the order of their costs. Private to src/surface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/simplify.h"
#include "collapsible_mesh.h"
#include "deviation_envelope.h"
#include "error_quadric.h"

namespace burnish {

// What all runs on one surface begin with.
struct CollapseStart {
  CollapseStart(const TriangleSoup& welded, const SimplifyOptions& options, double least_crease_angle);
  // The next angle to try where creases leave no room; at 180 there are none.
  static double raised(double crease_angle) { return crease_angle < 80 ? crease_angle + 30 : 180; }

  enum class Kind : char { smooth, chain, corner };
  double crease_angle;                  // that was taken
  CollapsibleMesh mesh;
  std::vector<Kind> kinds;              // of points
  std::vector<ErrorQuadric> quadrics;   // about each point
};

// What a point of the given surface, and all that merge with it, may do.
struct Restraint {
  static constexpr std::uint32_t kNoLimit = 0xffffffffu;
  static constexpr auto kDeviation = static_cast<float>(DeviationEnvelope::kShare);
  std::uint32_t most = kNoLimit;  // points that may merge
  float deviation = kDeviation;   // share of the deviation that they may use

  bool held() const { return most != kNoLimit || deviation != kDeviation; }
  void join(const Restraint& o) {
    most = std::min(most, o.most);
    deviation = std::min(deviation, o.deviation);
  }
};

class EdgeCollapser {
 public:
  // `restraints`: of each point. `envelope` may be null.
  EdgeCollapser(const CollapseStart& start, const SimplifyOptions& options, const std::vector<Restraint>& restraints, DeviationEnvelope* envelope,
                Progress& progress);

  void run();

  const CollapsibleMesh& mesh() const { return mesh_; }
  std::size_t collapsed() const { return collapsed_; }
  // The point that v has been merged into, and how many were.
  std::uint32_t merged(std::uint32_t v) const;
  std::uint32_t cluster_size(std::uint32_t v) const { return size_[v]; }
  // Whether creases keep more of the edges that are left than the deviation did in the last pass.
  bool creases_stopped_it() const;
  // Why the last edges stayed.
  std::string what_stopped_it() const;

 private:
  using Kind = CollapseStart::Kind;
  struct Candidate {
    double cost;
    std::uint32_t edge;
    std::uint32_t version;  // of both points, summed
    // Costs first; among equal ones the lower number.
    bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : edge > o.edge; }
  };
  struct Merge {
    double cost = 0;
    Vec3 to;
  };

  bool may_merge(std::uint32_t a, std::uint32_t b, bool sharp) const;
  Vec3 best_place(std::uint32_t a, std::uint32_t b, const ErrorQuadric& about_middle, const Vec3& middle) const;
  std::optional<Merge> evaluate(std::uint32_t h) const;
  bool look_around(std::uint32_t v, std::uint32_t other, const Vec3& to, double& worst, double& worst_before, double& area) const;
  void push(std::uint32_t h);
  void push_around(std::uint32_t v);
  void fill_queue();
  bool take(const Candidate& candidate);
  void merge(std::uint32_t h, const Merge& merge);
  bool done() const;
  std::uint32_t version(std::uint32_t h) const { return version_[mesh_.origin(h)] + version_[mesh_.target(h)]; }

  const SimplifyOptions& options_;
  DeviationEnvelope* envelope_;
  Progress& progress_;
  CollapsibleMesh mesh_;
  std::vector<Kind> kinds_;
  std::vector<ErrorQuadric> quadrics_;
  std::vector<Restraint> restraints_;
  std::vector<std::uint32_t> size_;
  std::vector<std::uint32_t> into_;
  std::vector<std::uint32_t> version_;
  std::priority_queue<Candidate> queue_;
  double least_shape_ = 0;
  std::size_t collapsed_ = 0;
  std::size_t beyond_deviation_ = 0, beyond_limit_ = 0;  // refusals of the last pass
};

}  // namespace burnish
