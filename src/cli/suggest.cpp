#include "suggest.h"

#include <algorithm>
#include <filesystem>

namespace burnish {
namespace {

std::string_view without_dashes(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  return word;
}

bool abbreviates(std::string_view word, std::string_view candidate) {
  return without_dashes(word).size() >= 3 && candidate.starts_with(word);
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, change});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::optional<std::string> best;
  // Strictly better than this is near: within a third of the letters, but always within one of three.
  std::size_t bound = without_dashes(word).size() / 3 + 1;
  if (without_dashes(word).size() < 3) bound = 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = abbreviates(word, candidate) ? 1 : edit_distance(word, candidate);
    if (distance >= bound + (best ? 0 : 1)) continue;
    best = candidate;
    bound = distance;
  }
  return best;
}

std::optional<std::string> nearest_file(const std::string& path) {
  namespace fs = std::filesystem;
  // Names nobody would read through are not worth the time: an upper limit keeps huge folders cheap.
  constexpr std::size_t kMaxEntries = 10'000;
  const fs::path wanted(path);
  const fs::path folder = wanted.parent_path();
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end;) {
    if (names.size() < kMaxEntries) names.push_back(at->path().filename().string());
    at.increment(error);
  }
  std::sort(names.begin(), names.end());
  const auto name = nearest(wanted.filename().string(), names);
  if (!name) return std::nullopt;
  return (folder / *name).string();
}

}  // namespace burnish
