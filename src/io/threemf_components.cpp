#include "threemf_components.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace burnish {
namespace {

constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
constexpr std::size_t kLongestTag = std::size_t{1} << 20;  // a longer one counts as ended, so that memory is bounded
constexpr std::string_view kSpace = " \t\r\n";

// Without the prefix of its namespace.
std::string_view local_name(std::string_view tag) {
  const std::string_view name = tag.substr(1, tag.find_first_of(" \t\r\n/>", 2) - 1);
  return name.substr(name.find(':') + 1);  // npos + 1 is 0
}

std::string attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = 0; (at = tag.find(name, at)) != tag.npos; at += name.size()) {
    if (kSpace.find(tag[at - 1]) == kSpace.npos) continue;
    const std::size_t equals = tag.find_first_not_of(kSpace, at + name.size());
    if (equals == tag.npos || tag[equals] != '=') continue;
    const std::size_t quote = tag.find_first_not_of(kSpace, equals + 1);
    if (quote == tag.npos) continue;
    return std::string(tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1));
  }
  return {};
}

// As lib3mf reads numbers: 01 is 1. Nothing for one that is spelled with entities, which no program does.
std::optional<std::uint64_t> id_in(std::string_view tag, std::string_view name) {
  const std::string text = attribute(tag, name);
  if (text.find('&') != text.npos) return std::nullopt;
  return std::strtoull(text.c_str(), nullptr, 10);
}

bool ends(std::string_view tag) {
  char open = 0;
  for (const char c : tag)
    if (open ? c == open : c == '"' || c == '\'') open = open ? '\0' : c;
  return open == 0;
}

}  // namespace

void ComponentCounter::put(std::string_view piece) {
  while (!piece.empty()) {
    const std::size_t at = piece.find(in_tag_ ? '>' : '<');
    const bool found = at != piece.npos;
    const std::size_t taken = found ? at + 1 : piece.size();
    if (in_tag_) tag_ += piece.substr(0, taken);
    piece.remove_prefix(taken);
    if (!found && !(in_tag_ && tag_.size() >= kLongestTag)) return;
    if (!in_tag_) {
      in_tag_ = true;
      tag_.assign(1, '<');
    } else if (tag_.size() >= kLongestTag || ends(tag_)) {
      in_tag_ = false;
      take(tag_);
    }
  }
}

void ComponentCounter::take(std::string_view tag) {
  const std::string_view name = local_name(tag);
  if (name != "object" && name != "component") return;
  const std::optional<std::uint64_t> id = id_in(tag, name == "object" ? "id" : "objectid");
  std::uint64_t more = id ? 1 : kMost;
  if (name == "object")
    object_ = id.value_or(0);
  else if (const auto part = placements_.find(id.value_or(0)); part != placements_.end())
    more = std::max(more, part->second);
  std::uint64_t& sum = placements_[object_];
  sum = std::min(kMost, sum + more);
  most_ = std::max(most_, sum);
}

}  // namespace burnish
