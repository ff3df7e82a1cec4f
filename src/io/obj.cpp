// Wavefront OBJ: `v`, `f` (v, v/vt, v/vt/vn, v//vn; indices from 1, or negative from the last point),
// `o` and `g`. Everything else (texture, materials, curves) says nothing about the surface; colours of
// materials are in a file of their own, which is not looked for.
#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "polygon_builder.h"
#include "readers.h"
#include "text_scanner.h"

namespace burnish {
namespace {

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : source_(source), scan_(source.bytes), builder_(source) {}

  MeshFile read() {
    while (!scan_.at_end()) {
      const char* at = scan_.position();
      const std::string_view line = next_line();
      TextScanner words(line);
      handle(words.word(), words, at);
    }
    return builder_.finish(MeshFormat::obj);
  }

 private:
  // The line up to its end, with the lines that a backslash joins to it.
  std::string_view next_line() {
    std::string_view line = scan_.rest_of_line();
    if (!line.ends_with('\\')) [[likely]]
      return line;
    joined_.clear();
    while (line.ends_with('\\')) {
      joined_.append(line.substr(0, line.size() - 1)).append(" ");
      skip_line_end();
      line = scan_.rest_of_line();
    }
    return joined_.append(line);
  }

  void skip_line_end() {
    const char* p = scan_.position();
    if (p < scan_.end() && *p == '\r') ++p;
    if (p < scan_.end() && *p == '\n') ++p;
    scan_.move_to(p);
  }

  void handle(std::string_view keyword, TextScanner& words, const char* at) {
    if (keyword == "v") return on_point(words, at);
    if (keyword == "f" || keyword == "fo") return on_face(words, at);
    if (keyword == "g" || keyword == "o") return builder_.begin_group(std::string(words.rest_of_line()));
  }

  // Behind the coordinates there may be a weight or a colour.
  void on_point(TextScanner& words, const char* at) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      if (!words.number(p[axis])) p[axis] = refused_number(words.word(), at);
    builder_.add_point(p, at);
  }

  double refused_number(std::string_view word, const char* at) {
    if (!source_.salvage && !word.empty())
      source_.fail_at(at, "expected a point's finite coordinate, found " + quoted(word),
                      has_decimal_comma(word)
                          ? "the file uses decimal commas; re-export it with decimal points"
                          : kSalvageHint);
    return std::numeric_limits<double>::quiet_NaN();
  }

  void on_face(TextScanner& words, const char* at) {
    corners_.clear();
    while (!words.at_end() && *words.position() != '#') {
      const std::string_view word = words.word();
      std::int64_t index = 0;
      if (!read_corner(word, index))
        return builder_.add_broken_polygon(at, "expected the index of a point, found " + quoted(word));
      corners_.push_back(index);
    }
    builder_.add_polygon(corners_, at);
  }

  bool read_corner(std::string_view word, std::int64_t& index) const {
    const char* end = word.data() + word.size();
    const auto [behind, error] = std::from_chars(word.data(), end, index);
    if (error != std::errc{} || (behind < end && *behind != '/') || index == 0) return false;
    index = index > 0 ? index - 1 : static_cast<std::int64_t>(builder_.point_count()) + index;
    return index >= 0;
  }

  const Source& source_;
  TextScanner scan_;
  PolygonBuilder builder_;
  std::string joined_;
  std::vector<std::int64_t> corners_;
};

}  // namespace

MeshFile read_obj(const Source& source) { return ObjReader(source).read(); }

}  // namespace burnish
