#include "burnish/levelset/redistance.h"

#include <algorithm>

#include "closest_point_march.h"
#include "pde_redistance.h"

namespace burnish {

std::string_view name(RedistanceMethod method) {
  switch (method) {
    case RedistanceMethod::closest: return "closest";
    case RedistanceMethod::fmm: return "fmm";
    case RedistanceMethod::pde_weno5: return "pde-weno5";
    case RedistanceMethod::pde_first: return "pde-first";
  }
  return "";
}

template <class T>
RedistanceResult redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress) {
  if (options.method == RedistanceMethod::pde_weno5 || options.method == RedistanceMethod::pde_first)
    return detail::pde_redistance(level_set, options, progress);
  detail::closest_point_redistance(level_set, options, progress);
  return {};
}

template <class T>
void redistance(BasicLevelSet<T>& level_set, double reach, Progress& progress) {
  RedistanceOptions options;
  options.reach = std::min(level_set.band, reach);
  redistance(level_set, options, progress);
}

template RedistanceResult redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template RedistanceResult redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

template void redistance(BasicLevelSet<float>&, double, Progress&);
template void redistance(BasicLevelSet<double>&, double, Progress&);

}  // namespace burnish
