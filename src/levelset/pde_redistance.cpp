#include "pde_redistance.h"

#include "burnish/core/error.h"

namespace burnish::detail {

template <class T>
RedistanceResult pde_redistance(BasicLevelSet<T>&, const RedistanceOptions&, Progress&) {
  throw Error(ErrorCode::usage, "redistancing by a PDE is not there yet");
}

template RedistanceResult pde_redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template RedistanceResult pde_redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

}  // namespace burnish::detail
