#include "burnish/levelset/offset.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"

namespace burnish {
namespace {

// phi becomes value(phi) everywhere; the band is |cells| narrower.
template <class T, class Value>
void replace(BasicLevelSet<T>& set, double cells, Value&& value) {
  const double band = set.band - std::abs(cells);
  if (!(band > kLeastBand))
    throw Error(ErrorCode::usage, "distances of " + std::to_string(set.band) + " cells are too few for an offset of " + std::to_string(cells),
                "a band wider than the offset by more than 3 cells is enough");
  const T limit = static_cast<T>(band), by = static_cast<T>(cells);
  parallel_for(set.phi.values().size(), [&](std::size_t i) {
    T& phi = set.phi.values()[i];
    phi = std::clamp(value(phi, by), -limit, limit);
  }, 16384);
  set.band = band;
}

}  // namespace

template <class T>
void offset(BasicLevelSet<T>& level_set, double cells) {
  replace(level_set, cells, [](T phi, T by) { return phi + by; });  // [T-SMOOTH-12]
}

template <class T>
void hollow(BasicLevelSet<T>& level_set, double cells) {
  if (cells >= 0)
    replace(level_set, cells, [](T phi, T by) { return std::min(phi, by - phi); });  // [T-SMOOTH-13]
  else
    replace(level_set, cells, [](T phi, T by) { return std::min(-phi, phi - by); });
}

template void offset(BasicLevelSet<float>&, double);
template void offset(BasicLevelSet<double>&, double);
template void hollow(BasicLevelSet<float>&, double);
template void hollow(BasicLevelSet<double>&, double);

}  // namespace burnish
