// What a model's coordinates are in. An STL does not say; `--units` does, or a file that knows.
//
// Nothing is computed from it but the conversion of lengths that were given in another unit: coordinates stay what they are.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace burnish {

enum class ModelUnit { millimetre, centimetre, metre, inch, micrometre, foot };

inline constexpr std::array kModelUnits{ModelUnit::millimetre, ModelUnit::centimetre, ModelUnit::metre, ModelUnit::inch, ModelUnit::micrometre, ModelUnit::foot};

// "mm", "cm", "m", "in", "um", "ft": on the command line, in summaries, and in reports.
std::string_view name(ModelUnit unit);
// The unit of that name; empty for any other text.
std::optional<ModelUnit> model_unit(std::string_view name);
// `value` in `from`, as a number in `to`: the nearest double or its neighbour, and the value itself between equal units. Inches are 25.4 mm.
double converted(double value, ModelUnit from, ModelUnit to);
// " mm", " mm^2" or " mm^3": to stand behind a number; empty without a unit.
std::string unit_suffix(const std::optional<ModelUnit>& unit, int power = 1);

}  // namespace burnish
