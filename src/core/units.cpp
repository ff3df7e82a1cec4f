#include "burnish/core/units.h"

#include <array>
#include <cstddef>

namespace burnish {
namespace {

struct Row {
  std::string_view name;
  double metres;
};
constexpr std::array<Row, 6> kRows{{{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2}, {"inch", 0.0254}, {"foot", 0.3048}, {"meter", 1}}};

}  // namespace

std::string_view name(ModelUnit unit) { return kRows[static_cast<std::size_t>(unit)].name; }

std::optional<ModelUnit> model_unit(std::string_view name) {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (kRows[i].name == name) return static_cast<ModelUnit>(i);
  return std::nullopt;
}

double in_metres(ModelUnit unit) { return kRows[static_cast<std::size_t>(unit)].metres; }

}  // namespace burnish
