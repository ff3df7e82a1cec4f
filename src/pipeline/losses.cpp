#include "losses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace burnish {
namespace {

constexpr double kPlacesAcross = 16;
constexpr std::size_t kMostLosses = 1000;  // listed; beyond that the last one stands for the rest

}  // namespace

std::vector<Loss> gather_losses(const std::vector<FarSample>& far, double diagonal,
                                const std::function<std::string(const FarSample&)>& reason_of) {
  using Place = std::pair<std::string, std::array<double, 3>>;
  std::map<Place, Loss> places;
  const double side = diagonal / kPlacesAcross;
  for (const FarSample& sample : far) {
    const std::string reason = reason_of(sample);
    const Vec3 at = sample.at / side;
    Loss& loss = places[{reason, {std::floor(at.x), std::floor(at.y), std::floor(at.z)}}];
    loss.reason = reason;
    loss.area += sample.area;
    ++loss.samples;
    if (sample.distance < loss.distance) continue;
    loss.distance = sample.distance;
    loss.position = sample.at;
  }
  std::vector<Loss> losses;
  losses.reserve(places.size());
  for (auto& [place, loss] : places) losses.push_back(std::move(loss));
  std::stable_sort(losses.begin(), losses.end(), [](const Loss& a, const Loss& b) { return std::pair(a.area, a.distance) > std::pair(b.area, b.distance); });
  for (std::size_t i = kMostLosses; i < losses.size(); ++i) {
    losses[kMostLosses - 1].area += losses[i].area;
    losses[kMostLosses - 1].samples += losses[i].samples;
  }
  if (losses.size() > kMostLosses) losses.resize(kMostLosses);
  return losses;
}

}  // namespace burnish
