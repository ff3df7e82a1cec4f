// Diffusion of the displacement of a surface in the band around it: what steps of any length are made of.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "heat_kernel.h"

namespace burnish::detail {

// The displacement w by which diffusion for a time changes the distance phi, (exp(time Laplacian) - 1) phi, along the normals of the surface
// constant, in the finest leaves around it; kUnknown elsewhere. It is diffused by itself, in a band that lets nothing out: what phi is
// farther away, or would be beyond a band, is of no concern. [T-SMOOTH-3, T-SMOOTH-4]
class SurfaceDiffusion {
 public:
  // For level sets on this octree with phi in this layout.
  explicit SurfaceDiffusion(const LevelSet& set);

  // Begins again from phi, a distance where |phi| < limit: w for `time`.
  void start(const LevelSet& set, double limit, double time, Progress& progress);
  // Goes on until w is that for `time` more. What has been diffused for a longer time takes it in passes as long as those of the start.
  void go_on(double time, Progress& progress);
  // Diffuses w for `time` and adds nothing: its mean along the surface.
  void average(double time, Progress& progress);

  const Field<float>& displacement() const { return moved_; }
  Field<float>& displacement() { return moved_; }
  // The leaves in which it is known.
  const std::vector<std::uint32_t>& leaves() const { return leaves_; }

  // Where w is known, w = change(leaf, node, w).
  template <class Change>
  void change(Change&& change) {
    parallel_for(leaves_.size(), [&](std::size_t i) {
      float* w = moved_.block(leaves_[i]);
      for (std::size_t n = 0; n < kBlockNodes; ++n)
        if (is_known(w[n])) w[n] = change(leaves_[i], n, w[n]);
    }, 16);
  }
  // The same with the second derivatives of phi + w, known or not.
  void change_by_bends(const LevelSet& set, const std::function<float(float w, float phi, float trace, float square)>& change);

 private:
  enum class Source : std::uint8_t { none, add };
  // A leaf and layers around it as far as there are leaves of its size; unknown beyond.
  void gather_finest(const Field<float>& field, std::uint32_t leaf, int width, float* dense) const;
  void find_leaves(const LevelSet& set, double domain);
  void pass(const HeatTaps& taps, Source source, Progress& progress);

  const Octree& tree_;
  std::vector<std::uint32_t> finest_, leaves_;
  HeatTaps taps_;
  Field<float> source_, moved_, next_;
};

}  // namespace burnish::detail
