// PLY, in text and in binary of either byte order.
//
// The header declares elements (vertex, face, ...), each with properties in any order and of any type.
// Rows are read property by property; only x, y and z of `vertex` and, of `face`, the list `vertex_indices`
// (or `vertex_index`), bytes for colours and the number of a group that a comment names matter, the rest is
// stepped over. Every number a PLY can hold fits a double.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "polygon_builder.h"
#include "readers.h"
#include "text_scanner.h"

namespace burnish {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

enum class Role : std::uint8_t { none, x, y, z, corners, red, green, blue, alpha, group };
constexpr std::size_t kRoles = 10;

struct Property {
  Role role = Role::none;
  bool is_list = false;
  Type count_type = Type::uint8;
  Type type = Type::float32;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { text, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::map<std::int64_t, std::string> group_names;  // of lines `comment group NUMBER NAME`
  const char* body = nullptr;
};

constexpr std::string_view kReexport = "re-export the file";

class HeaderReader {
 public:
  explicit HeaderReader(const Source& source) : source_(source), scan_(source.bytes) {}

  Header read() {
    next_line();
    // A file whose lines end in CR alone may go on with a byte of data that looks like LF.
    cr_only_ = scan_.position() < scan_.end() && *scan_.position() == '\r' && !followed_by_line_feed();
    bool has_format = false;
    for (;;) {
      skip_line_end();
      if (scan_.position() == scan_.end())
        source_.fail_at(scan_.end(), "expected 'end_header', found the file's end", kReexport);
      TextScanner words(next_line());
      const std::string_view keyword = words.word();
      if (keyword == "end_header") break;
      if (keyword == "format")
        read_format(words), has_format = true;
      else if (keyword == "element")
        read_element(words);
      else if (keyword == "property")
        read_property(words);
      else if (keyword == "comment")
        read_comment(words);
    }
    skip_line_end();
    if (!has_format) source_.fail_at(source_.begin(), "the header has no line 'format'", kReexport);
    header_.body = scan_.position();
    return std::move(header_);
  }

 private:
  std::string_view next_line() {
    line_at_ = scan_.position();
    return scan_.rest_of_line();
  }
  bool followed_by_line_feed() const {
    return scan_.position() + 1 < scan_.end() && scan_.position()[1] == '\n';
  }

  void skip_line_end() {
    const char* p = scan_.position();
    if (p < scan_.end()) ++p;
    if (p < scan_.end() && p[-1] == '\r' && *p == '\n' && !cr_only_) ++p;
    scan_.move_to(p);
  }

  [[noreturn]] void refuse(const std::string& expected, std::string_view found) const {
    source_.fail_at(line_at_, fmt::format("expected {}, found {}", expected, quoted(found)), kReexport);
  }

  void read_format(TextScanner& words) {
    const std::string_view format = words.word();
    if (format == "ascii")
      header_.encoding = Encoding::text;
    else if (format == "binary_little_endian")
      header_.encoding = Encoding::little_endian;
    else if (format == "binary_big_endian")
      header_.encoding = Encoding::big_endian;
    else
      refuse("format ascii, binary_little_endian or binary_big_endian", format);
  }

  void read_element(TextScanner& words) {
    Element element;
    element.name = words.word();
    const std::string_view count = words.word();
    const auto [behind, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc{} || behind != count.data() + count.size())
      refuse(fmt::format("the number of elements {}", quoted(element.name)), count);
    header_.elements.push_back(std::move(element));
  }

  void read_property(TextScanner& words) {
    if (header_.elements.empty()) refuse("'element' before 'property'", "property");
    Element& element = header_.elements.back();
    Property p;
    std::string_view type = words.word();
    p.is_list = type == "list";
    if (p.is_list) {
      p.count_type = type_of(words.word());
      if (p.count_type == Type::float32 || p.count_type == Type::float64)
        refuse("a whole-numbered count", "float");
      type = words.word();
    }
    p.type = type_of(type);
    p.role = role_of(element.name, words.word(), p);
    element.properties.push_back(p);
  }

  void read_comment(TextScanner& words) {
    if (words.word() != "group") return;
    const std::string_view word = words.word();
    std::int64_t number = 0;
    const auto [behind, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error == std::errc{} && behind == word.data() + word.size())
      header_.group_names.emplace(number, words.rest_of_line());
  }

  Type type_of(std::string_view name) const {
    constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
    for (std::size_t t = 0; t < kNames.size(); ++t)
      if (name == kNames[t][0] || name == kNames[t][1]) return static_cast<Type>(t);
    refuse("the type of a property", name);
  }

  static Role role_of(std::string_view element, std::string_view property, const Property& p) {
    if (element == "vertex" && !p.is_list)
      return property == "x" ? Role::x : property == "y" ? Role::y : property == "z" ? Role::z : Role::none;
    if (element != "face") return Role::none;
    if (p.is_list)
      return property == "vertex_indices" || property == "vertex_index" ? Role::corners : Role::none;
    if (property == "group") return Role::group;
    if (p.type != Type::uint8) return Role::none;
    return property == "red"     ? Role::red
           : property == "green" ? Role::green
           : property == "blue"  ? Role::blue
           : property == "alpha" ? Role::alpha
                                 : Role::none;
  }

  const Source& source_;
  TextScanner scan_;
  Header header_;
  const char* line_at_ = nullptr;
  bool cr_only_ = false;
};

// What a row's next value was.
enum class Got { value, nonsense, end };

// The values of a body in text. Types do not matter there.
class TextValues {
 public:
  TextValues(const char* begin, const char* end) : scan_({begin, static_cast<std::size_t>(end - begin)}) {}

  const char* position() {
    scan_.skip_blanks();
    return scan_.position();
  }
  Got next(Type, double& value) {
    if (scan_.number(value)) return Got::value;
    if (scan_.word().empty()) return Got::end;
    value = std::numeric_limits<double>::quiet_NaN();
    return Got::nonsense;
  }

 private:
  TextScanner scan_;
};

template <class T>
T swapped(T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

static_assert(std::endian::native == std::endian::little,
              "big-endian values are swapped, little-endian ones copied");

template <bool kSwap>
class BinaryValues {
 public:
  BinaryValues(const char* begin, const char* end) : position_(begin), end_(end) {}

  const char* position() const { return position_; }
  Got next(Type type, double& value) {
    switch (type) {
      case Type::int8:
        return take<std::int8_t>(value);
      case Type::uint8:
        return take<std::uint8_t>(value);
      case Type::int16:
        return take<std::int16_t>(value);
      case Type::uint16:
        return take<std::uint16_t>(value);
      case Type::int32:
        return take<std::int32_t>(value);
      case Type::uint32:
        return take<std::uint32_t>(value);
      case Type::float32:
        return take<float>(value);
      case Type::float64:
        break;
    }
    return take<double>(value);
  }

 private:
  template <class T>
  Got take(double& value) {
    if (static_cast<std::size_t>(end_ - position_) < sizeof(T)) return Got::end;
    T raw;
    std::memcpy(&raw, position_, sizeof raw);
    position_ += sizeof raw;
    value = static_cast<double>(kSwap ? swapped(raw) : raw);
    return Got::value;
  }

  const char* position_;
  const char* end_;
};

template <class Values>
class BodyReader {
 public:
  BodyReader(const Source& source, const Header& header, Values values)
      : source_(source), header_(header), values_(values), builder_(source) {}

  MeshFile read(MeshFormat format) {
    for (const Element& element : header_.elements)
      if (!read_element(element)) break;
    if (groups_are_scattered_) {
      builder_.forget_groups();
      builder_.add_warning("the faces of a group do not follow each other: groups were left out");
    }
    return builder_.finish(format);
  }

 private:
  // False when nothing after this element can be read, in salvage.
  bool read_element(const Element& element) {
    if (element.properties.empty()) return true;  // its rows have no bytes
    for (std::uint64_t row = 0; row < element.count; ++row) {
      const char* at = values_.position();
      const Got got = read_row(element, at);
      if (got == Got::value) continue;
      const std::string what =
          got == Got::end
              ? fmt::format("truncated at {}: header promises {} of {}, file holds {}",
                            source_.place(source_.end()), element.count, quoted(element.name), row)
              : fmt::format("{}: a list of {} has no valid length", source_.place(at), quoted(element.name));
      if (!source_.salvage) source_.fail(what);
      builder_.add_warning(what);
      return false;
    }
    return true;
  }

  // `nonsense` when the length of a list cannot be known, and so neither what follows it.
  Got read_row(const Element& element, const char* at) {
    row_values_.fill(std::numeric_limits<double>::quiet_NaN());
    bool has_corners = false;
    for (const Property& p : element.properties) {
      double value = 0;
      if (p.is_list) {
        const Got got = read_list(p);
        if (got != Got::value) return got;
        has_corners |= p.role == Role::corners;
        continue;
      }
      if (values_.next(p.type, value) == Got::end) return Got::end;
      row_values_[static_cast<std::size_t>(p.role)] = value;
    }
    if (element.name == "vertex")
      builder_.add_point({value_of(Role::x), value_of(Role::y), value_of(Role::z)}, at);
    if (has_corners) add_polygon(at);
    return Got::value;
  }

  double value_of(Role role) const { return row_values_[static_cast<std::size_t>(role)]; }

  void add_polygon(const char* at) {
    builder_.set_color(std::isnan(value_of(Role::red)) ? kNoColor : color());
    if (!header_.group_names.empty() && !std::isnan(value_of(Role::group)))
      enter_group(value_of(Role::group));
    builder_.add_polygon(corners_, at);
  }

  // Text may hold numbers that are no bytes.
  Color color() const {
    const auto byte = [&](Role role, std::uint32_t otherwise) {
      const double value = value_of(role);
      return std::isnan(value) ? otherwise : static_cast<std::uint32_t>(std::clamp(value, 0.0, 255.0));
    };
    return color_of(byte(Role::red, 0), byte(Role::green, 0), byte(Role::blue, 0), byte(Role::alpha, 255));
  }

  void enter_group(double value) {
    const auto number = static_cast<std::int64_t>(std::clamp(value, -1e15, 1e15));
    if (number == group_ || groups_are_scattered_) return;
    group_ = number;
    groups_are_scattered_ = !entered_.insert(number).second;
    const auto named = header_.group_names.find(number);
    builder_.begin_group(named == header_.group_names.end() ? "" : named->second);
  }

  Got read_list(const Property& p) {
    double count = 0;
    const Got got = values_.next(p.count_type, count);
    if (got != Got::value) return got;
    if (!(count >= 0) || count != std::floor(count)) return Got::nonsense;
    if (p.role == Role::corners) corners_.clear();
    for (double i = 0; i < count; ++i) {
      double value = 0;
      if (values_.next(p.type, value) == Got::end) return Got::end;
      if (p.role == Role::corners) corners_.push_back(corner(value));
    }
    return Got::value;
  }

  // -1, which the builder refuses, for what is no index.
  static std::int64_t corner(double value) {
    const bool is_index = value >= 0 && value <= 4294967295.0 && value == std::floor(value);
    return is_index ? static_cast<std::int64_t>(value) : -1;
  }

  const Source& source_;
  const Header& header_;
  Values values_;
  PolygonBuilder builder_;
  std::vector<std::int64_t> corners_;
  std::array<double, kRoles> row_values_{};  // of a row by role, not a number where there is none
  std::optional<std::int64_t> group_;
  std::set<std::int64_t> entered_;
  bool groups_are_scattered_ = false;
};

template <class Values>
MeshFile read_body(const Source& source, const Header& header, MeshFormat format) {
  return BodyReader<Values>(source, header, Values(header.body, source.end())).read(format);
}

}  // namespace

MeshFile read_ply(const Source& source) {
  const Header header = HeaderReader(source).read();
  if (header.encoding == Encoding::text) return read_body<TextValues>(source, header, MeshFormat::ply_ascii);
  Source binary = source;
  binary.is_text = false;
  if (header.encoding == Encoding::big_endian)
    return read_body<BinaryValues<true>>(binary, header, MeshFormat::ply_binary);
  return read_body<BinaryValues<false>>(binary, header, MeshFormat::ply_binary);
}

}  // namespace burnish
