// The tags of an XML text in order, as far as VTK's files need it: no namespaces, no sections of CDATA.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "source.h"

namespace burnish::detail {

struct XmlTag {
  std::string_view name;
  std::string_view attributes;  // as they stand there
  bool is_end = false;          // </name>
  bool is_empty = false;        // <name/>
  const char* at = nullptr;

  // The value of an attribute, with the five named entities replaced; none if it is not there.
  std::optional<std::string> value(std::string_view attribute) const;
};

class XmlTags {
 public:
  explicit XmlTags(const Source& source) : source_(source), position_(source.begin()) {}

  // The next tag; none at the end. Comments and declarations are skipped. Throws Error{unreadable_input} where one does not end.
  std::optional<XmlTag> next();
  // Behind the last tag.
  const char* position() const { return position_; }
  // What stands between the last tag and the one that follows.
  std::string_view text() const;

 private:
  std::string_view rest() const { return {position_, static_cast<std::size_t>(source_.end() - position_)}; }

  const Source& source_;
  const char* position_;
};

}  // namespace burnish::detail
