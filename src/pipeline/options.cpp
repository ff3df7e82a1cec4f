#include "burnish/pipeline/options.h"

namespace burnish {

std::string_view name(Method method) {
  switch (method) {
    case Method::local: return "local";
    case Method::level_set: return "levelset";
    case Method::automatic: break;
  }
  return "auto";
}

std::string_view name(Nesting nesting) {
  switch (nesting) {
    case Nesting::solid: return "solid";
    case Nesting::cavity: return "cavity";
    case Nesting::automatic: break;
  }
  return "auto";
}

std::string_view name(Extractor surface) {
  switch (surface) {
    case Extractor::delaunay: return "delaunay";
    case Extractor::tetrahedra: return "tetrahedra";
    case Extractor::automatic: break;
  }
  return "auto";
}

std::string_view name(SmoothMode mode) {
  switch (mode) {
    case SmoothMode::feature: return "feature";
    case SmoothMode::volume: return "volume";
    case SmoothMode::mcf: return "mcf";
    case SmoothMode::filtered: return "filtered";
    case SmoothMode::reinit: return "reinit";
    case SmoothMode::automatic: break;
  }
  return "auto";
}

}  // namespace burnish
