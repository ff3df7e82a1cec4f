// Lengths as users write them: `0.5`, `0.2%`, `2h`, and `0.2mm` where the model's unit is known.
//
// Relative lengths are resolved once, where a run starts; everything behind that point is in the
// units of the model.
#pragma once

#include <optional>
#include <string_view>

#include "burnish/core/model_unit.h"

namespace burnish {

enum class LengthUnit {
  model,                // as the model's coordinates
  percent_of_diagonal,  // of the bounding box' diagonal
  cells,                // of the finest cell's side, h
};

struct Length {
  double value = 0;
  LengthUnit unit = LengthUnit::model;

  // The length in model units. `cell` is the finest cell's side; a cell size itself must not be
  // given in cells (the parser of such an option refuses it).
  double in_model_units(double diagonal, double cell) const {
    switch (unit) {
      case LengthUnit::percent_of_diagonal: return value * 0.01 * diagonal;
      case LengthUnit::cells: return value * cell;
      case LengthUnit::model: break;
    }
    return value;
  }
};

// Reads a finite, non-negative number followed by nothing, `%` or `h`. Locale-independent.
// With the model's `unit`, a unit's name may follow as well, and the length is converted to that of the model.
// Empty when `text` is anything else.
std::optional<Length> parse_length(std::string_view text, const std::optional<ModelUnit>& unit = std::nullopt);

// Reads a number of bytes: digits with an optional decimal point and an optional suffix k, M, G or T
// (powers of 1024, upper or lower case, optionally followed by B or iB). Empty when malformed or zero.
std::optional<unsigned long long> parse_bytes(std::string_view text);

}  // namespace burnish
