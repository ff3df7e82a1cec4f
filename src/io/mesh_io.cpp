// What a file is, and which reader gets it.
#include "burnish/io/mesh_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "mapped_file.h"
#include "readers.h"
#include "suffix.h"
#include "text_scanner.h"
#include "threemf.h"
#include "zip_archive.h"

namespace burnish {
namespace {

enum class Kind { stl_binary, stl_ascii, obj, ply, off, threemf };

// Where content is searched for signs of a format.
constexpr std::size_t kHead = 4096;

constexpr std::string_view kKnown = "give a file in one of the formats STL, OBJ, PLY, OFF or 3MF";

std::optional<Kind> kind_of_suffix(const std::string& suffix) {
  if (suffix == ".stl" || suffix == ".stla" || suffix == ".stlb") return Kind::stl_binary;
  if (suffix == ".obj") return Kind::obj;
  if (suffix == ".ply") return Kind::ply;
  if (suffix == ".off") return Kind::off;
  if (suffix == ".3mf") return Kind::threemf;
  return std::nullopt;
}

// True when header, count and size agree to the byte: no text does that by chance.
bool is_exact_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return bytes.size() == 84 + 50 * static_cast<std::uint64_t>(count);
}

bool has_binary_bytes(std::string_view bytes) {
  return std::any_of(
      bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), kHead)),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 && !is_blank(c) && c != 0x1a; });
}

// Whether the words of an ASCII STL stand in the head of a file that begins with "solid". Names may
// hold any byte, and so may the headers of binary files.
bool has_stl_words(std::string_view bytes) {
  TextScanner head(bytes.substr(0, kHead));
  while (!head.at_end()) {
    const std::uint64_t key = fold_keyword(head.word());
    const std::uint64_t next = fold_keyword(head.peek());
    if (key == fold_keyword("endsolid")) return true;
    if (key == fold_keyword("facet") && (next == fold_keyword("normal") || next == fold_keyword("outer")))
      return true;
    if (key == fold_keyword("outer") && next == fold_keyword("loop")) return true;
  }
  return false;
}

// The first word of the first line that is not a comment.
std::string_view first_word(std::string_view bytes) {
  TextScanner scan(bytes);
  while (!scan.at_end() && *scan.position() == '#') scan.rest_of_line();
  return scan.peek();
}

bool is_obj_word(std::string_view word) {
  constexpr std::array<std::string_view, 12> kWords{"v", "vt", "vn", "vp", "f",      "o",
                                                    "g", "s",  "l",  "p",  "mtllib", "usemtl"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

bool is_off_word(std::string_view word) {
  return word.size() >= 3 && word.size() <= 7 && word.substr(word.size() - 3) == "OFF" &&
         word.find_first_not_of("STCN4n") >= word.size() - 3;
}

std::optional<Kind> kind_of_content(std::string_view bytes) {
  if (is_exact_binary_stl(bytes)) return Kind::stl_binary;
  if (is_zip(bytes)) return Kind::threemf;
  const std::string_view word = first_word(bytes);
  if (word == "ply") return Kind::ply;
  if (is_off_word(word)) return Kind::off;
  if (fold_keyword(word.substr(0, 5)) == fold_keyword("solid"))
    return has_stl_words(bytes) || !has_binary_bytes(bytes) ? Kind::stl_ascii : Kind::stl_binary;
  if (fold_keyword(word) == fold_keyword("facet") && has_stl_words(bytes)) return Kind::stl_ascii;
  if (has_binary_bytes(bytes)) return std::nullopt;
  if (is_obj_word(word)) return Kind::obj;
  return std::nullopt;
}

[[noreturn]] void refuse_unknown_text(const Source& source) {
  const std::string_view word = first_word(source.bytes);
  if (word.empty()) source.fail("is empty but for blanks and comments", kKnown);
  source.fail_at(word.data(), "expected the beginning of an STL, OBJ, PLY or OFF, found " + quoted(word),
                 kKnown);
}

// Files of other kinds that are given to mesh programs, by their first bytes.
void refuse_foreign(const Source& source) {
  struct Foreign {
    std::string_view magic, what, hint;
  };
  constexpr std::array<Foreign, 5> kForeign{{
      {"\x1f\x8b", "compressed with gzip", "unpack it with gunzip"},
      {"ISO-10303-21", "a STEP file", "export an STL"},
      {"glTF", "a binary glTF file", "export an STL"},
      {"<?xml", "an XML file", "export an STL"},
      {"<!DOCTYPE", "a web page", "download the file itself"},
  }};
  for (const Foreign& f : kForeign)
    if (source.bytes.starts_with(f.magic)) source.fail(fmt::format("is {}", f.what), f.hint);
}

Kind kind_of(const Source& source, const std::optional<Kind>& by_suffix) {
  if (const auto kind = kind_of_content(source.bytes)) return *kind;
  refuse_foreign(source);
  if (by_suffix == Kind::ply)
    source.fail_at(source.begin(), "expected 'ply', found " + quoted(first_word(source.bytes)), kKnown);
  if (by_suffix == Kind::off || by_suffix == Kind::obj) return *by_suffix;
  if (by_suffix == Kind::threemf)
    source.fail("expected a ZIP archive, as every 3MF is, found " + quoted(source.bytes.substr(0, 8)), kKnown);
  if (!has_binary_bytes(source.bytes)) refuse_unknown_text(source);
  return Kind::stl_binary;
}

MeshFile read_as(Kind kind, Source& source) {
  source.is_text = kind != Kind::stl_binary && kind != Kind::threemf;
  switch (kind) {
    case Kind::stl_ascii:
      return read_stl_ascii(source);
    case Kind::obj:
      return read_obj(source);
    case Kind::ply:
      return read_ply(source);
    case Kind::off:
      return read_off(source);
    case Kind::threemf:
      return read_3mf(source);
    case Kind::stl_binary:
      break;
  }
  return read_stl_binary(source);
}

void drop_byte_order_mark(std::string_view& bytes) {
  if (bytes.starts_with("\xef\xbb\xbf") && !is_exact_binary_stl(bytes)) bytes.remove_prefix(3);
}

MeshFile read_bytes(std::string_view bytes, const std::string& label, const MeshReadOptions& options) {
  Source source{bytes, label, options.salvage, true};
  if (bytes.empty()) source.fail("is empty (0 bytes)", kKnown);
  drop_byte_order_mark(source.bytes);
  const auto by_suffix = kind_of_suffix(suffix_of(label));
  const Kind kind = kind_of(source, by_suffix);
  MeshFile file = read_as(kind, source);
  if (file.soup.facets.empty())
    source.fail(fmt::format("holds no facets ({}{})", name(file.format),
                            file.warnings.empty() ? "" : ": " + file.warnings.front()),
                kKnown);
  const bool is_stl = kind == Kind::stl_ascii || kind == Kind::stl_binary;
  if (by_suffix && *by_suffix != (is_stl ? Kind::stl_binary : kind))
    file.warnings.push_back(fmt::format("read as {}, in spite of the name's suffix", name(file.format)));
  return file;
}

}  // namespace

std::string_view name(MeshFormat format) {
  constexpr std::array<std::string_view, 7> kNames{"binary STL", "ASCII STL", "OBJ", "binary PLY",
                                                   "ASCII PLY",  "OFF",       "3MF"};
  return kNames[static_cast<std::size_t>(format)];
}

MeshFile read_mesh(const std::string& path, const MeshReadOptions& options) {
  const MappedFile file(path);
  return read_bytes(file.bytes(), input_label(path), options);
}

MeshFile read_mesh(std::span<const std::byte> bytes, const std::string& label,
                   const MeshReadOptions& options) {
  return read_bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, label, options);
}

MeshFormat format_for_writing(const std::string& path) {
  const std::string suffix = suffix_of(path);
  if (suffix == ".stla") return MeshFormat::stl_ascii;
  const auto kind = kind_of_suffix(suffix);
  if (kind == Kind::stl_binary) return MeshFormat::stl_binary;
  if (kind == Kind::obj) return MeshFormat::obj;
  if (kind == Kind::ply) return MeshFormat::ply_binary;
  if (kind == Kind::off) return MeshFormat::off;
  if (kind == Kind::threemf) {
    require_3mf(path, ErrorCode::usage);
    return MeshFormat::threemf;
  }
  throw Error(ErrorCode::usage, fmt::format("{}: the suffix does not say which format to write", path),
              "use .stl, .stla (ASCII), .ply, .obj, .off or .3mf");
}

bool stores_float32(MeshFormat format) {
  return format == MeshFormat::stl_binary || format == MeshFormat::stl_ascii || format == MeshFormat::threemf;
}

}  // namespace burnish
