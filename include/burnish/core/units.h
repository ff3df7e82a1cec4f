// Units of length: what a model's coordinates are counted in, where its file says so.
#pragma once

#include <optional>
#include <string_view>

namespace burnish {

// The units that a 3MF file can have.
enum class ModelUnit { micron, millimeter, centimeter, inch, foot, meter };

// As 3MF spells it: "micron", "millimeter", "centimeter", "inch", "foot", "meter".
std::string_view name(ModelUnit unit);

// The unit of that name; nothing for other words.
std::optional<ModelUnit> model_unit(std::string_view name);

// How long one is, in metres, to the nearest double: an inch has 0.0254 m, a foot 0.3048 m, by definition.
double in_metres(ModelUnit unit);

}  // namespace burnish
