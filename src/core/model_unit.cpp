#include "burnish/core/model_unit.h"

#include <fmt/format.h>

namespace burnish {
namespace {

struct Row {
  std::string_view name;
  double nanometres;  // whole numbers, so that conversions are exact but for one multiplication and one division
};

constexpr std::array<Row, kModelUnits.size()> kRows{{{"mm", 1e6}, {"cm", 1e7}, {"m", 1e9}, {"in", 25'400'000}, {"um", 1e3}, {"ft", 304'800'000}}};

const Row& row(ModelUnit unit) { return kRows[static_cast<std::size_t>(unit)]; }

}  // namespace

std::string_view name(ModelUnit unit) { return row(unit).name; }

std::optional<ModelUnit> model_unit(std::string_view name) {
  for (const ModelUnit unit : kModelUnits)
    if (row(unit).name == name) return unit;
  return std::nullopt;
}

double converted(double value, ModelUnit from, ModelUnit to) { return from == to ? value : value * row(from).nanometres / row(to).nanometres; }

std::string unit_suffix(const std::optional<ModelUnit>& unit, int power) {
  if (!unit) return {};
  return power == 1 ? fmt::format(" {}", name(*unit)) : fmt::format(" {}^{}", name(*unit), power);
}

}  // namespace burnish
