#include "keep_volume.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "burnish/levelset/volume.h"

namespace burnish::detail {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kFirst = 0.05;    // cells: the first step of the secant method
constexpr double kFarthest = 1.5;  // cells that distances allow before they are made again
constexpr double kSlight = 0.1;    // cells: a shift that leaves them as they are
constexpr int kRounds = 60, kSteps = 12;

// What is no distance says on which side of the surface it is, and no more.
void shift(const Field<float>& from, const Field<float>* mobility, double by, Field<float>& phi) {
  const auto s = static_cast<float>(by);
  parallel_for(phi.values().size(), [&](std::size_t i) {
    const float d = from.values()[i];
    phi.values()[i] = std::abs(d) >= static_cast<float>(kFlowBand) ? d : d + (mobility == nullptr ? s : s * mobility->values()[i]);
  }, 16384);
}

}  // namespace

double shift_to_volume(LevelSet& level_set, double wanted, const VolumeShift& how, Progress& progress) {
  double volume = enclosed_volume(level_set), total = 0;
  const auto is_met = [&] { return std::abs(volume - wanted) <= kTolerance * std::abs(wanted); };
  if (is_met()) return volume;
  const Field<float> flowed = level_set.phi;
  Field<float> later;
  for (int round = 0; round < kRounds && !is_met(); ++round) {
    const Field<float>& from = round == 0 ? flowed : (later = level_set.phi);
    double s0 = 0, v0 = volume, s1 = volume < wanted ? kFirst : -kFirst;
    bool is_stuck = false;
    for (int step = 0; step < kSteps && !is_met(); ++step) {
      progress.check();
      shift(from, how.mobility, s1, level_set.phi);
      how.constrain();
      volume = enclosed_volume(level_set);
      const double slope = (volume - v0) / (s1 - s0);
      is_stuck = !(slope > 0);
      const double next = is_stuck ? s1 : std::clamp(s1 + (wanted - volume) / slope, -kFarthest, kFarthest);
      s0 = s1, v0 = volume;
      if (next == s1) break;
      if (!is_met()) s1 = next;
    }
    if (is_stuck) break;
    total += s1;
    if (std::abs(total) > how.farthest) {
      level_set.phi = flowed;
      return enclosed_volume(level_set);
    }
    if (std::abs(s1) < kSlight) break;
    how.redistance();
    how.constrain();
    volume = enclosed_volume(level_set);
  }
  return volume;
}

}  // namespace burnish::detail
