#include "flow_mesh_cells.h"

#include <algorithm>
#include <cmath>

namespace burnish {
namespace {

constexpr double kTrialShare = 0.125;     // of the cells that are wanted, in the first mesh
constexpr double kLeastTrial = 20'000;    // below that, cells in the depth of a model do not show
constexpr double kNearEnough = 0.1;
constexpr std::size_t kMostTrials = 3;
constexpr double kExponent = 2.2, kLeastExponent = 1, kGreatestExponent = 4;

}  // namespace

double CellChooser::cell_for(double cells) const {
  if (trials_.empty()) return std::sqrt(kCellsPerArea * area_ / cells);
  const auto log_of = [](const MeshTrial& t) { return std::log(static_cast<double>(t.cells)); };
  const MeshTrial& last = trials_.back();
  double exponent = kExponent;
  if (trials_.size() > 1) {
    const MeshTrial& before = trials_[trials_.size() - 2];
    const double measured = (log_of(last) - log_of(before)) / std::log(before.cell / last.cell);
    if (std::isfinite(measured)) exponent = std::clamp(measured, kLeastExponent, kGreatestExponent);
  }
  return last.cell * std::pow(static_cast<double>(last.cells) / cells, 1 / exponent);
}

std::optional<double> CellChooser::next() const {
  if (trials_.empty()) return cell_for(std::max(kTrialShare * wanted_, std::min(wanted_, kLeastTrial)));
  const double off = std::abs(static_cast<double>(trials_.back().cells) / wanted_ - 1);
  if (off <= kNearEnough || trials_.size() == kMostTrials) return std::nullopt;
  return cell_for(wanted_);
}

}  // namespace burnish
