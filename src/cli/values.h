// Setters' helpers: what a value must look like, and what to say when it does not.
//
// All throw Error{usage} whose message reads `--cell 0,5: not a length` and whose hint is the way out.
// Reading is independent of the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/core/length.h"
#include "burnish/core/vec.h"
#include "burnish/pipeline/options.h"
#include "command_line.h"

namespace burnish {

// A length greater than zero, in any unit.
Length positive_length(const GivenValue& given);
// A cell's side, or what is needed before there are cells: greater than zero, and not in cells.
Length length_without_cells(const GivenValue& given);
// A volume not below zero, in the model's units or in percent of the largest component's.
VolumeLimit volume_limit(const GivenValue& given);
// The number of the word among those that the row lists; an enumerator of T, whose order is theirs.
std::size_t place_among(const GivenValue& given);
template <class T>
T one_of(const GivenValue& given) {
  return static_cast<T>(place_among(given));
}
// The same with words that the row does not list.
std::size_t place_among(const GivenValue& given, const std::vector<std::string>& words);
template <class T>
T one_of(const GivenValue& given, const std::vector<std::string>& words) {
  return static_cast<T>(place_among(given, words));
}
// Whether it is a word that the row lists, such as the 'auto' of a length.
bool is_listed(const GivenValue& given);
// A whole number within [least, most].
std::uint64_t integer_within(const GivenValue& given, std::uint64_t least, std::uint64_t most);
// A finite number.
double finite_number(const GivenValue& given);
// A finite number that is not negative.
double non_negative_number(const GivenValue& given);
// A finite number above zero.
double positive_number(const GivenValue& given);
// A number of bytes such as 800M or 4G.
std::uint64_t byte_count(const GivenValue& given);
// xmin,ymin,zmin,xmax,ymax,zmax.
Box3 box_of(const GivenValue& given);
// What stands between commas, one part or more.
std::vector<std::string_view> parts_of(std::string_view list);
// NAME=V,NAME=V: names and the texts of values. `example` is for the hint.
std::vector<std::pair<std::string, std::string_view>> named_values(const GivenValue& given, std::string_view example);

// What `--redistance` takes: closest, fmm, pde-weno5 and pde-first, in the order of RedistanceMethod.
Value redistance_methods(std::string_view name);

// Setters that only store.
Setter switch_on(bool& flag);
Setter store_text(std::string& text);

}  // namespace burnish
