#include "patch_names.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string_view>

namespace burnish {
namespace {

// A patch of that name would take it away from the group, and conditions for all walls would be that patch's alone.
constexpr std::string_view kGroupOfWalls = "wall";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80; }

std::string plain(const std::string& name) {
  std::string result = name;
  for (char& c : result)
    if (!is_letter(c) && !(c >= '0' && c <= '9') && std::string_view("_-+.").find(c) == std::string_view::npos) c = '_';
  return result.empty() || !(is_letter(result[0]) || result[0] == '_') ? "_" + result : result;
}

}  // namespace

std::vector<std::string> patch_names(const std::vector<MeshPatch>& patches) {
  std::vector<std::string> names;
  std::set<std::string> taken{std::string(kGroupOfWalls)};
  std::map<std::string, int> next;  // number to be tried for a name that is taken
  for (const MeshPatch& patch : patches) {
    const std::string name = plain(patch.name);
    std::string free = name;
    int& number = next.try_emplace(name, 2).first->second;
    while (!taken.insert(free).second) free = fmt::format("{}_{}", name, number++);
    names.push_back(free);
  }
  return names;
}

}  // namespace burnish
