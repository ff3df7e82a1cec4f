#include "foam_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "text_scanner.h"

namespace burnish {
namespace {

constexpr std::string_view kEntryHint = "correct the file there: brackets come in pairs, and entries are 'name value;' or 'name { ... }'";
constexpr std::string_view kReadHint = "what is read is OpenFOAM's text or binary, plain or gzipped, of the byte order of this machine";

// A file of the largest meshes is smaller; a few bytes can stand for far more.
constexpr std::size_t kMostUnpacked = std::size_t{64} << 30;

// Bytes of a value of a list in binary; 0: lists of it are text.
std::size_t bytes_of(std::string_view type, const FoamFormat& format) {
  const auto scalar = static_cast<std::size_t>(format.scalar_bytes), label = static_cast<std::size_t>(format.label_bytes);
  if (type == "scalar" || type == "sphericalTensor") return scalar;
  if (type == "vector" || type == "point") return 3 * scalar;
  if (type == "symmTensor") return 6 * scalar;
  if (type == "tensor") return 9 * scalar;
  if (type == "label") return label;
  return type == "bool" ? 1 : 0;
}

bool is_space(char c) { return static_cast<unsigned char>(c) <= ' '; }

// Walks through the text of dictionaries.
class EntryScanner {
 public:
  EntryScanner(const Source& source, std::string_view text, const FoamFormat& format)
      : source_(source), format_(format), at_(text.data()), end_(text.data() + text.size()) {}

  std::vector<FoamEntry> all() {
    std::vector<FoamEntry> entries;
    while (skip()) {
      if (*at_ == ';') {
        ++at_;
      } else if (*at_ == '#') {
        skip_directive();
      } else if (*at_ == '(') {
        skip_bracket('(', ')');
      } else if (*at_ == '}' || *at_ == ')') {
        source_.fail_at(at_, fmt::format("'{}' closes nothing", *at_), kEntryHint);
      } else {
        const FoamEntry entry = next();
        // A macro stands for entries that are elsewhere; a number, for the length of a list.
        if (entry.name.front() != '$' && !entry.name.empty()) entries.push_back(entry);
      }
    }
    return entries;
  }

 private:
  // To what is neither blank nor comment. False at the end.
  bool skip() {
    while (at_ < end_) {
      if (is_space(*at_))
        ++at_;
      else if (*at_ != '/' || !skip_comment())
        return true;
    }
    return false;
  }

  bool skip_comment() {
    const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    const bool line = rest.starts_with("//"), block = rest.starts_with("/*");
    if (!line && !block) return false;
    const std::size_t to = line ? rest.find('\n') : rest.find("*/", 2);
    at_ = to == rest.npos ? end_ : at_ + to + (line ? 1 : 2);
    return true;
  }

  void skip_quoted() {
    for (++at_; at_ < end_ && *at_ != '"'; ++at_)
      if (*at_ == '\\' && at_ + 1 < end_) ++at_;
    if (at_ < end_) ++at_;
  }

  void skip_directive() {
    while (at_ < end_ && *at_ != '\n') {
      if (at_ + 1 < end_ && at_[0] == '#' && at_[1] == '{') return skip_verbatim();
      *at_ == '"' ? skip_quoted() : void(++at_);
    }
  }

  void skip_verbatim() {
    const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    const std::size_t to = rest.find("#}");
    if (to == rest.npos) source_.fail_at(at_, "'#{' is not closed", "add the '#}' that ends it");
    at_ += to + 2;
  }

  // One character of a value, or what has to be passed over as a whole.
  void skip_part() {
    if (*at_ == '"') return skip_quoted();
    if (*at_ == '#' && at_ + 1 < end_ && at_[1] == '{') return skip_verbatim();
    if (*at_ == '/' && skip_comment()) return;
    if (*at_ == '{') return skip_bracket('{', '}');
    if (*at_ == '(') return skip_bracket('(', ')');
    if (format_.binary && *at_ == 'L' && skip_binary_list()) return;
    ++at_;
  }

  void skip_bracket(char open, char close) {
    const char* start = at_++;
    if (++depth_ > kDeepest) source_.fail_at(start, "brackets within brackets, too many of them", kEntryHint);
    while (at_ < end_ && *at_ != close) {
      if (*at_ == (close == ')' ? '}' : ')')) source_.fail_at(at_, fmt::format("'{}' where '{}' of a list or dictionary was expected", *at_, close), kEntryHint);
      skip_part();
    }
    if (at_ == end_) source_.fail_at(start, fmt::format("'{}' is not closed", open), kEntryHint);
    ++at_;
    --depth_;
  }

  // List<scalar> 8(...)
  bool skip_binary_list() {
    const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    const std::size_t close = rest.substr(0, 40).find('>');
    if (!rest.starts_with("List<") || close == rest.npos) return false;
    const std::size_t each = bytes_of(rest.substr(5, close - 5), format_);
    if (each == 0) return false;
    at_ += close + 1;
    skip();
    std::size_t count = 0;
    while (at_ < end_ && *at_ >= '0' && *at_ <= '9' && count < rest.size()) count = 10 * count + static_cast<std::size_t>(*at_++ - '0');
    skip();
    if (at_ == end_ || *at_ != '(') return true;
    if (static_cast<std::size_t>(end_ - at_) / each < count) source_.fail_at(at_, fmt::format("the file ends within a list of {} values", count), kCutOffHint);
    at_ += 1 + count * each;
    if (at_ >= end_ || *at_ != ')') source_.fail_at(std::min(at_, end_), "expected ')' behind a list in binary", "the file is damaged: copy it again, or write the field as text with foamFormatConvert");
    ++at_;
    return true;
  }

  FoamEntry next() {
    FoamEntry entry;
    const char* start = at_;
    if (*at_ == '"')
      skip_quoted();
    else
      while (at_ < end_ && !is_space(*at_) && *at_ != ';' && *at_ != '{' && *at_ != '}' && *at_ != '"') ++at_;
    if (at_ == start) source_.fail_at(start, fmt::format("expected an entry's name, found {}", quoted({start, 1})), kEntryHint);
    entry.name = {start, static_cast<std::size_t>(at_ - start)};
    if (!skip()) return entry;
    const char* value = at_;
    if (*at_ == '{') {
      skip_bracket('{', '}');
      entry.value = {value + 1, static_cast<std::size_t>(at_ - value - 2)};
      entry.is_dictionary = true;
      return entry;
    }
    // The length of a list has no ';' behind it.
    if (*at_ == '(' && entry.name.find_first_not_of("0123456789") == entry.name.npos) return skip_bracket('(', ')'), entry;
    while (at_ < end_ && *at_ != ';' && *at_ != '}' && *at_ != ')') skip_part();
    const char* behind = at_;
    while (behind > value && is_space(behind[-1])) --behind;
    entry.value = {value, static_cast<std::size_t>(behind - value)};
    return entry;
  }

  static constexpr int kDeepest = 200;
  const Source& source_;
  const FoamFormat& format_;
  const char* at_;
  const char* end_;
  int depth_ = 0;
};

// "LSB;label=32;scalar=64"
void read_arch(const Source& source, std::string_view arch, FoamFormat& format) {
  const auto bits = [&](std::string_view name) {
    const std::size_t at = arch.find(name);
    const std::string_view digits = at == arch.npos ? "" : arch.substr(at + name.size(), 2);
    if (digits != "32" && digits != "64") source.fail(fmt::format("expected {}32 or {}64 in arch, found {}", name, name, quoted(arch)), kReadHint);
    return digits == "32" ? 4 : 8;
  };
  if (arch.find("MSB") != arch.npos && format.binary) source.fail("its numbers are binary, with their most significant byte first", kReadHint);
  format.label_bytes = bits("label=");
  format.scalar_bytes = bits("scalar=");
}

}  // namespace

std::string unpack_gzip(std::string_view packed, const std::string& label, std::size_t most) {
  std::string out;
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw Error(ErrorCode::unreadable_input, label + ": cannot be unpacked", "free some memory, or unpack it with gunzip");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  std::vector<char> buffer(std::size_t{1} << 18);
  constexpr std::size_t kMost = std::size_t{1} << 30;  // zlib counts in 32 bits
  std::size_t taken = 0;
  for (;;) {
    if (stream.avail_in == 0) {
      const std::size_t next = std::min(packed.size() - taken, kMost);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
      stream.avail_in = static_cast<uInt>(next);
      taken += next;
    }
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    const int state = inflate(&stream, Z_NO_FLUSH);
    out.append(buffer.data(), buffer.size() - stream.avail_out);
    if (out.size() > most) throw Error(ErrorCode::unreadable_input, fmt::format("{}: unpacks to more than {:.3g} GB", label, static_cast<double>(most) * 0x1p-30), "unpack it with gunzip if that is right");
    if (state == Z_STREAM_END) {
      if (stream.avail_in == 0 && taken == packed.size()) return out;
      inflateReset(&stream);
    } else if (state != Z_OK) {
      throw Error(ErrorCode::unreadable_input, fmt::format("{}: byte {}: the gzip file is broken or cut off", label, taken - stream.avail_in), "copy it again; 'gunzip -t' tells whether it is whole");
    }
  }
}

FoamFile::FoamFile(const std::string& path) : path_(path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored) && std::filesystem::exists(path + ".gz", ignored)) path_ = path + ".gz", compressed_ = true;
  mapped_ = std::make_unique<MappedFile>(path_);
  if (!compressed_) return;
  unpacked_ = unpack_gzip(mapped_->bytes(), path_, kMostUnpacked);
  mapped_.reset();
}

bool FoamFile::exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) || std::filesystem::exists(path + ".gz", ignored);
}

std::vector<FoamEntry> foam_entries(const Source& source, std::string_view text, const FoamFormat& format) { return EntryScanner(source, text, format).all(); }

const FoamEntry* find_entry(const std::vector<FoamEntry>& entries, std::string_view name) {
  const auto at = std::find_if(entries.rbegin(), entries.rend(), [&](const FoamEntry& e) { return e.name == name; });
  return at == entries.rend() ? nullptr : &*at;
}

FoamHeader foam_header(Source& source, bool compressed) {
  FoamHeader header;
  header.format.compressed = compressed;
  FoamScanner scanner(source, header.format, source.begin());
  if (scanner.word() != "FoamFile" || !scanner.accept('{')) source.fail("it does not begin with a dictionary FoamFile: no file of an OpenFOAM case", "name the folder of a case, whose files begin with FoamFile { ... }");
  const char* begin = scanner.position();
  const auto size = static_cast<std::size_t>(source.end() - begin);
  const std::size_t close = std::string_view(begin, size).find('}');
  if (close == std::string_view::npos) source.fail("the file ends within its header FoamFile", kCutOffHint);
  header.end = begin + close + 1;
  const std::vector<FoamEntry> entries = foam_entries(source, {begin, close}, header.format);
  if (const FoamEntry* e = find_entry(entries, "class")) header.class_name = e->value;
  if (const FoamEntry* e = find_entry(entries, "format")) header.format.binary = e->value == "binary";
  if (const FoamEntry* e = find_entry(entries, "arch")) read_arch(source, e->value, header.format);
  source.is_text = !header.format.binary;
  return header;
}

std::string foam_header_text(std::string_view class_name, std::string_view object, const FoamFormat& format, std::string_view entries) {
  const std::string arch = format.binary ? fmt::format("    arch        \"LSB;label={};scalar={}\";\n", 8 * format.label_bytes, 8 * format.scalar_bytes) : "";
  return fmt::format("FoamFile\n{{\n    version     2.0;\n    format      {};\n{}    class       {};\n{}    object      {};\n}}\n", format.binary ? "binary" : "ascii", arch, class_name, entries,
                     object);
}

bool is_constraint(std::string_view patch_type) {
  constexpr std::array<std::string_view, 16> kConstraints{"empty", "wedge", "symmetry", "symmetryPlane", "cyclic", "cyclicAMI", "cyclicACMI", "cyclicSlip",
                                                          "nonuniformTransformCyclic", "processor", "processorCyclic", "overset", "cyclicPeriodicAMI",
                                                          "nonConformalCyclic", "nonConformalError", "nonConformalProcessorCyclic"};
  return std::find(kConstraints.begin(), kConstraints.end(), patch_type) != kConstraints.end();
}

// --- FoamScanner

bool FoamScanner::skip_comment() {
  const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
  const bool line = rest.starts_with("//");
  if (!line && !rest.starts_with("/*")) return false;
  const std::size_t to = line ? rest.find('\n') : rest.find("*/", 2);
  at_ = to == rest.npos ? end_ : at_ + to + (line ? 1 : 2);
  return true;
}

std::string FoamScanner::found() const {
  if (at_ >= end_) return "the end of the file";
  const char* to = at_;
  while (to < end_ && to - at_ < 20 && !is_space(*to)) ++to;
  return quoted({at_, static_cast<std::size_t>(std::max(to, at_ + 1) - at_)});
}

void FoamScanner::expect(char c, std::string_view where) {
  if (accept(c)) return;
  fail(fmt::format("expected '{}' {}, found {}", c, where, found()));
}

std::string_view FoamScanner::word() {
  skip();
  const char* start = at_;
  while (at_ < end_ && !is_space(*at_) && std::string_view("(){};").find(*at_) == std::string_view::npos) ++at_;
  return {start, static_cast<std::size_t>(at_ - start)};
}

std::uint64_t FoamScanner::label(std::string_view what) {
  skip();
  const char* start = at_;
  std::uint64_t value = 0;
  while (at_ < end_ && static_cast<unsigned char>(*at_ - '0') < 10) value = 10 * value + static_cast<std::uint64_t>(*at_++ - '0');
  const bool ends = at_ == end_ || is_space(*at_) || *at_ == ')' || *at_ == '(' || *at_ == '{' || *at_ == '}' || *at_ == '/' || *at_ == ';';
  if (at_ > start && at_ - start < 19 && ends) return value;
  at_ = start;
  if (at_ < end_ && *at_ == '#') fail(fmt::format("{}: directives are not supported in the files of a mesh", found()), "write the mesh again with a tool of OpenFOAM, which leaves none in it");
  fail(fmt::format("expected a {}, found {}", what, found()));
}

double FoamScanner::number() {
  skip();
  double value = 0;
  const char* behind = read_number(at_, end_, value);
  const bool ends = behind && (behind == end_ || is_space(*behind) || *behind == ')' || *behind == '/');
  if (!ends || !std::isfinite(value)) fail(fmt::format("expected a coordinate, found {}", found()), "three numbers in brackets make a point: correct it, or write the mesh again");
  at_ = behind;
  return value;
}

std::size_t FoamScanner::count(std::string_view of) {
  skip();
  const char* start = at_;
  const std::uint64_t value = label(fmt::format("number of {}", of));
  // Not believed before bytes are seen: each of them takes one at least.
  if (value <= static_cast<std::uint64_t>(end_ - at_)) return static_cast<std::size_t>(value);
  skip();
  if (at_ < end_ && *at_ == '{') return static_cast<std::size_t>(value);
  at_ = start;
  fail(fmt::format("{} {} are promised, and the file ends {} bytes later", value, of, end_ - start), kCutOffHint);
}

const char* FoamScanner::block(std::size_t count, std::size_t bytes_each, std::string_view what) {
  const char* start = at_;
  if (static_cast<std::size_t>(end_ - at_) / bytes_each < count) fail(fmt::format("{} {} are promised, and the file ends {} bytes later", count, what, end_ - at_), kCutOffHint);
  at_ += count * bytes_each;
  if (at_ == end_ || *at_ != ')') fail(fmt::format("expected ')' behind {} {} in binary, found {}", count, what, found()), "the file is damaged: copy it again, or write it as text with foamFormatConvert");
  ++at_;
  return start;
}

std::uint32_t FoamScanner::checked(std::uint64_t value, std::uint64_t bound, std::string_view what) const {
  if (value < bound) return static_cast<std::uint32_t>(value);
  const auto shown = static_cast<std::int64_t>(value);
  if (shown < 0) fail(fmt::format("{} {} does not exist: numbers begin at 0", what, shown));
  fail(fmt::format("{} {} does not exist: there are {}", what, shown, bound));
}

std::uint64_t FoamScanner::raw_label(const char* from) const {
  if (format_.label_bytes == 4) {
    std::int32_t value = 0;
    std::memcpy(&value, from, sizeof value);
    return static_cast<std::uint64_t>(std::int64_t{value});
  }
  std::uint64_t value = 0;
  std::memcpy(&value, from, sizeof value);
  return value;
}

double FoamScanner::raw_scalar(const char* from) const {
  float single = 0;
  double value = 0;
  if (format_.scalar_bytes == 8) return std::memcpy(&value, from, sizeof value), value;
  std::memcpy(&single, from, sizeof single);
  return single;
}

std::vector<Vec3> FoamScanner::points() {
  const std::size_t n = count("points");
  std::vector<Vec3> points;
  if (n == 0) return points;
  expect('(', "before the points");
  if (binary()) {
    const auto each = static_cast<std::size_t>(format_.scalar_bytes);
    const char* from = block(n, 3 * each, "points");
    points.resize(n);
    for (Vec3& p : points) {
      p = {raw_scalar(from), raw_scalar(from + each), raw_scalar(from + 2 * each)};
      from += 3 * each;
      if (!is_finite(p)) source_.fail_at(from - 3 * each, "a coordinate is not finite", "correct the point, or write the mesh again");
    }
    return points;
  }
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    expect('(', fmt::format("before point {} of {}", i, n));
    const double x = number(), y = number(), z = number();
    points.push_back({x, y, z});
    expect(')', "behind a point");
  }
  expect(')', "behind the points");
  return points;
}

std::vector<std::uint32_t> FoamScanner::labels(std::optional<std::size_t> size, std::uint64_t bound, std::string_view what) {
  const char* start = at_;
  const std::size_t n = count(fmt::format("{}s", what));
  if (size && n != *size) {
    at_ = start;
    skip();
    fail(fmt::format("expected a list of {}, found one of {}", *size, n), "points, faces, owner and neighbour are of one mesh: write the mesh again");
  }
  std::vector<std::uint32_t> values;
  if (accept('{')) {  // all the same
    if (!size) fail("a list of one and the same value was not expected", "cells and faces differ: write the mesh again");
    values.assign(n, checked(label(what), bound, what));
    expect('}', "behind the value");
    return values;
  }
  if (n == 0) {
    if (accept('(')) expect(')', "of an empty list");
    return values;
  }
  expect('(', "before a list");
  values.reserve(n);
  if (binary()) {
    const auto each = static_cast<std::size_t>(format_.label_bytes);
    const char* from = block(n, each, what);
    for (std::size_t i = 0; i < n; ++i) values.push_back(checked(raw_label(from + i * each), bound, what));
    return values;
  }
  for (std::size_t i = 0; i < n; ++i) values.push_back(checked(label(what), bound, what));
  expect(')', "behind a list");
  return values;
}

void FoamScanner::face(std::vector<std::uint32_t>& to, std::uint64_t bound) {
  const std::size_t n = count("points of a face");
  expect('(', "before the points of a face");
  if (binary()) {
    const auto each = static_cast<std::size_t>(format_.label_bytes);
    const char* from = block(n, each, "points of a face");
    for (std::size_t i = 0; i < n; ++i) to.push_back(checked(raw_label(from + i * each), bound, "point"));
    return;
  }
  for (std::size_t i = 0; i < n; ++i) to.push_back(checked(label("point"), bound, "point"));
  expect(')', "behind the points of a face");
}

}  // namespace burnish
