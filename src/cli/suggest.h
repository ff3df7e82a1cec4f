// 'Did you mean': the nearest of a few known words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace burnish {

// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`
// (no letter touched twice).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate nearest to `word`: one that `word` abbreviates (by three letters or more), or else one
// within a third of the word's length. The first of equals; empty when none is near.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

// The name of an entry of the same folder that `path` seems to mean, with the folder as in `path`.
std::optional<std::string> nearest_file(const std::string& path);

}  // namespace burnish
