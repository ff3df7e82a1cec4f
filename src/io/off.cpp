// OFF and its variants with colours, normals and texture coordinates (COFF, NOFF, STOFF, ...), in text.
// A vertex and a face each take a line. What follows a face's indices may be its colour; what follows a
// point's coordinates is skipped.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "polygon_builder.h"
#include "readers.h"
#include "text_scanner.h"

namespace burnish {
namespace {

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), scan_(source.bytes), builder_(source) {}

  MeshFile read() {
    read_keyword();
    const std::size_t points = read_count("vertices");
    const std::size_t faces = read_count("faces");
    skip_line();  // the number of edges, if it is there, is not needed
    if (read_rows(points, "vertices", [this](const char* at) { read_point(at); }))
      read_rows(faces, "faces", [this](const char* at) { read_face(at); });
    return builder_.finish(MeshFormat::off);
  }

 private:
  bool at_end() {
    while (!scan_.at_end() && *scan_.position() == '#') scan_.rest_of_line();
    return scan_.at_end();
  }
  std::string_view word() { return at_end() ? std::string_view{} : scan_.word(); }

  void skip_line() { scan_.rest_of_line(); }

  void read_keyword() {
    at_end();
    const std::string_view keyword = scan_.peek();
    double number = 0;
    if (TextScanner(keyword).number(number)) return builder_.add_warning("the keyword OFF is missing");
    if (!keyword.ends_with("OFF"))
      source_.fail_at(keyword.data(), "expected 'OFF', found " + quoted(keyword));
    if (keyword.find_first_of("4n") != keyword.npos)
      source_.fail_at(keyword.data(), "expected points of three coordinates, found " + quoted(keyword),
                      "export the model in three dimensions");
    scan_.word();
    if (!at_end() && scan_.peek() == "BINARY")
      source_.fail_at(scan_.position(), "binary OFF cannot be read", "export the file as text");
  }

  std::size_t read_count(std::string_view noun) {
    const std::string_view w = word();
    std::size_t count = 0;
    const auto [behind, error] = std::from_chars(w.data(), w.data() + w.size(), count);
    if (error != std::errc{} || behind != w.data() + w.size())
      source_.fail_at(w.empty() ? source_.end() : w.data(),
                      fmt::format("expected the number of {}, found {}", noun, quoted(w)),
                      "re-export the file");
    return count;
  }

  // Calls `read_row` for each of `count` rows. False when the file ends before them, in salvage.
  template <class ReadRow>
  bool read_rows(std::size_t count, std::string_view noun, ReadRow read_row) {
    for (std::size_t row = 0; row < count; ++row) {
      if (at_end()) {
        const std::string what = fmt::format("truncated at {}: header promises {} {}, file holds {}",
                                             source_.place(source_.end()), count, noun, row);
        if (!source_.salvage) source_.fail(what);
        builder_.add_warning(what);
        return false;
      }
      read_row(scan_.position());
      skip_line();
    }
    return true;
  }

  void read_point(const char* at) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      if (at_end() || !scan_.number(p[axis])) {
        if (!source_.salvage && !scan_.at_end())
          source_.fail_at(at, "expected a point's finite coordinate, found " + quoted(scan_.peek()),
                          has_decimal_comma(scan_.peek())
                              ? "the file uses decimal commas; re-export it with decimal points"
                              : kSalvageHint);
        p[axis] = std::numeric_limits<double>::quiet_NaN();
        break;
      }
    }
    builder_.add_point(p, at);
  }

  void read_face(const char* at) {
    double count = 0;
    const std::string_view word = scan_.peek();
    if (!scan_.number(count) || count < 0 || count != std::floor(count))
      return builder_.add_broken_polygon(at,
                                         "expected the number of a face's corners, found " + quoted(word));
    corners_.clear();
    for (double i = 0; i < count; ++i) {
      double index = 0;
      if (at_end() || !scan_.number(index) || std::abs(index) > 1e15 || index != std::floor(index))
        return builder_.add_broken_polygon(
            at, fmt::format("expected {} indices of points, found {} and {}", count, i,
                            scan_.at_end() ? "the file's end" : quoted(scan_.peek())));
      corners_.push_back(static_cast<std::int64_t>(index));
    }
    builder_.set_color(read_color());
    builder_.add_polygon(corners_, at);
  }

  // Three or four numbers up to the line's end: whole ones go to 255, others to 1. A single one counts in a
  // table of colours that nobody has.
  Color read_color() {
    TextScanner words(scan_.rest_of_line());
    std::array<double, 4> channels{0, 0, 0, 0};
    std::size_t count = 0;
    bool whole = true;
    for (; count < 4 && !words.at_end() && *words.position() != '#'; ++count) {
      whole &= words.peek().find_first_of(".eE") == std::string_view::npos;
      if (!words.number(channels[count])) return kNoColor;
    }
    if (count < 3) return kNoColor;
    const double scale = whole ? 1 : 255;
    if (count == 3) channels[3] = 255 / scale;
    std::array<std::uint32_t, 4> bytes{};
    for (std::size_t i = 0; i < 4; ++i)
      bytes[i] = static_cast<std::uint32_t>(std::clamp(std::round(channels[i] * scale), 0.0, 255.0));
    return color_of(bytes[0], bytes[1], bytes[2], bytes[3]);
  }

  const Source& source_;
  TextScanner scan_;
  PolygonBuilder builder_;
  std::vector<std::int64_t> corners_;
};

}  // namespace

MeshFile read_off(const Source& source) { return OffReader(source).read(); }

}  // namespace burnish
