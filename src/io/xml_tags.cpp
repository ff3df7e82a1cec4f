#include "xml_tags.h"

#include <algorithm>
#include <array>
#include <utility>

#include "text_scanner.h"

namespace burnish::detail {
namespace {

bool ends_name(char c) { return is_blank(c) || c == '/' || c == '>' || c == '='; }

std::string_view take_name(std::string_view& text) {
  const auto end = std::find_if(text.begin(), text.end(), ends_name);
  const std::string_view name(text.data(), static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(name.size());
  return name;
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
}

std::string without_entities(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{{{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  std::string plain;
  while (!text.empty()) {
    const auto entity = std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& e) { return text.starts_with(e.first); });
    plain += entity == kEntities.end() ? text.front() : entity->second;
    text.remove_prefix(entity == kEntities.end() ? 1 : entity->first.size());
  }
  return plain;
}

// The end of a tag's text, which may hold '>' in quotes; npos if there is none.
std::size_t end_of_tag(std::string_view text) {
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quote != 0) {
      if (text[i] == quote) quote = 0;
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '>') {
      return i;
    }
  }
  return text.npos;
}

}  // namespace

std::optional<std::string> XmlTag::value(std::string_view attribute) const {
  std::string_view rest = attributes;
  for (;;) {
    skip_blanks(rest);
    const std::string_view found = take_name(rest);
    skip_blanks(rest);
    if (found.empty() || rest.empty() || rest.front() != '=') return std::nullopt;
    rest.remove_prefix(1);
    skip_blanks(rest);
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) return std::nullopt;
    const std::size_t end = rest.find(rest.front(), 1);
    if (end == rest.npos) return std::nullopt;
    if (found == attribute) return without_entities(rest.substr(1, end - 1));
    rest.remove_prefix(end + 1);
  }
}

std::optional<XmlTag> XmlTags::next() {
  for (;;) {
    const std::size_t open = rest().find('<');
    if (open == std::string_view::npos) return std::nullopt;
    XmlTag tag;
    tag.at = position_ + open;
    position_ = tag.at + 1;
    const bool is_comment = rest().starts_with("!--");
    const std::size_t end = is_comment ? rest().find("-->") : end_of_tag(rest());
    if (end == std::string_view::npos) source_.fail_at(tag.at, "expected the end of a tag, found that of the file", "the file was cut off: copy it again, or export the volume again");
    std::string_view inside = rest().substr(0, end);
    position_ += end + (is_comment ? 3 : 1);
    if (inside.starts_with('!') || inside.starts_with('?')) continue;
    tag.is_end = inside.starts_with('/');
    if (tag.is_end) inside.remove_prefix(1);
    tag.is_empty = inside.ends_with('/');
    if (tag.is_empty) inside.remove_suffix(1);
    tag.name = take_name(inside);
    tag.attributes = inside;
    return tag;
  }
}

std::string_view XmlTags::text() const { return rest().substr(0, rest().find('<')); }

}  // namespace burnish::detail
