// ASCII STL, as it is met rather than as it was meant: keywords in any case, words that mean nothing
// (normals that are no numbers, remarks behind a keyword), any line ends or none at all.
//
// The grammar hangs on five words: `facet` and `outer` open, `vertex` gives a corner, `endloop` and
// `endfacet` close. A loop of more than three vertices is cut into a fan, with a warning; one of fewer,
// and one with a corner that cannot be read, is an error, or left out in salvage.
#include <fmt/format.h>

#include <cmath>

#include "counts.h"
#include "huge_pages.h"
#include "readers.h"
#include "text_scanner.h"

namespace burnish {
namespace {

constexpr std::uint64_t kSolid = fold_keyword("solid");
constexpr std::uint64_t kFacet = fold_keyword("facet");
constexpr std::uint64_t kNormal = fold_keyword("normal");
constexpr std::uint64_t kOuter = fold_keyword("outer");
constexpr std::uint64_t kLoop = fold_keyword("loop");
constexpr std::uint64_t kVertex = fold_keyword("vertex");
constexpr std::uint64_t kEnd = fold_keyword("end");
constexpr std::uint64_t kEndLoop = fold_keyword("endloop");
constexpr std::uint64_t kEndFacet = fold_keyword("endfacet");
constexpr std::uint64_t kEndSolid = fold_keyword("endsolid");

constexpr std::string_view kFacetHint = "re-export the file, or pass --salvage to leave such facets out";
constexpr std::string_view kCommaHint =
    "the file uses decimal commas; re-export it with decimal points, or pass --salvage to read them as they "
    "are";

bool is_keyword(std::uint64_t key) {
  return key == kSolid || key == kFacet || key == kOuter || key == kLoop || key == kVertex ||
         key == kEndLoop || key == kEndFacet || key == kEndSolid;
}

class AsciiStlReader {
 public:
  explicit AsciiStlReader(const Source& source) : source_(source), scan_(source.bytes) {
    // A facet of real files takes 150 to 300 bytes; what is too much here is never touched.
    reserve_on_huge_pages(soup_.points, 3 * (source.bytes.size() / 160 + 1));
    reserve_on_huge_pages(soup_.facets, source.bytes.size() / 160 + 1);
  }

  MeshFile read() {
    while (!scan_.at_end()) {
      const char* at = scan_.position();
      handle(scan_.word(), at);
    }
    finish();
    MeshFile file;
    file.format = MeshFormat::stl_ascii;
    file.soup = std::move(soup_);
    file.warnings = warnings();
    return file;
  }

 private:
  void handle(std::string_view word, const char* at) {
    switch (fold_keyword(word)) {
      case kVertex:
        return on_vertex(at);
      case kFacet:
        return on_facet(at);
      case kOuter:
        return on_outer(at);
      case kEndLoop:
        return close_loop();
      case kEndFacet:
        return close_facet();
      case kSolid:
        return on_solid();
      case kEndSolid:
        return on_end_solid();
      case kEnd:
        return on_end(at);
      case kLoop:
        return;
      default:
        odd_words_.add(at);
    }
  }

  void on_solid() {
    close_facet();
    in_solid_ = true;
    close_group();
    soup_.groups.push_back({std::string(name()), facet_count(), 0});
  }

  void on_end_solid() {
    close_facet();
    in_solid_ = false;
    name();
  }

  // "end loop" and its like, in two words.
  void on_end(const char* at) {
    switch (fold_keyword(scan_.peek())) {
      case kLoop:
        scan_.word();
        return close_loop();
      case kFacet:
        scan_.word();
        return close_facet();
      case kSolid:
        scan_.word();
        return on_end_solid();
      default:
        odd_words_.add(at);
    }
  }

  // The rest of the line, but not the facets of a file that has no lines.
  std::string_view name() {
    const std::string_view line = scan_.rest_of_line();
    TextScanner words(line);
    for (const char* last = line.data(); !words.at_end();) {
      const char* at = words.position();
      if (fold_keyword(words.word()) == kFacet && fold_keyword(words.peek()) == kNormal) {
        scan_.move_to(at);
        return {line.data(), static_cast<std::size_t>(last - line.data())};
      }
      last = words.position();
    }
    return line;
  }

  void on_facet(const char* at) {
    close_facet();
    facet_at_ = at;
    facet_has_loop_ = false;
    if (fold_keyword(scan_.peek()) != kNormal) return;
    scan_.word();
    for (int i = 0; i < 3 && !is_keyword(fold_keyword(scan_.peek())); ++i) scan_.word();
  }

  void on_outer(const char* at) {
    close_loop();
    if (!facet_at_) facet_at_ = at;
  }

  void on_vertex(const char* at) {
    if (!facet_at_) {
      if (!source_.salvage) source_.fail_at(at, "expected 'facet', found 'vertex'");
      facet_at_ = at;
    }
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      if (!scan_.number(p[axis]) && !salvage_number(p[axis], axis)) {
        loop_is_broken_ = true;
        break;
      }
    soup_.points.push_back(p);
  }

  // What a word that is no finite number means: an error, except in salvage, where decimal commas are
  // understood and everything else is stepped over. Keywords stay for `handle`.
  bool salvage_number(double& value, int axis) {
    const std::string_view word = scan_.peek();
    if (!source_.salvage) refuse_number(word, axis);
    if (is_keyword(fold_keyword(word))) return false;
    scan_.word();
    const auto number = whole_number(word, true);
    if (!number || !std::isfinite(*number)) return false;
    decimal_commas_.add(word.data());
    value = *number;
    return true;
  }

  [[noreturn]] void refuse_number(std::string_view word, int axis) {
    if (word.empty()) source_.fail_at(word.data(), "truncated: the file ends within a facet");
    const bool infinite = whole_number(word).has_value();
    source_.fail_at(
        word.data(),
        fmt::format("{} of a vertex: expected {}, found {}", std::string_view("xyz").substr(axis, 1),
                    infinite ? "a finite number" : "a number", quoted(word)),
        has_decimal_comma(word) ? kCommaHint : kFacetHint);
  }

  void close_loop() {
    const std::size_t corners = soup_.points.size() - loop_start_;
    if (corners == 3 && !loop_is_broken_) [[likely]] {
      emit_facet();
    } else if (corners > 3 && !loop_is_broken_) {
      many_vertices_.add(facet_at_);
      emit_fan();
    } else if (corners > 0) {
      drop_facet(corners);
    } else {
      return;
    }
    facet_has_loop_ = true;
    loop_is_broken_ = false;
    loop_start_ = soup_.points.size();
  }

  void close_facet() {
    close_loop();
    if (facet_at_ && !facet_has_loop_) drop_facet(0);
    facet_at_ = nullptr;
    facet_has_loop_ = false;
  }

  void emit_facet() {
    require_room_for_facet(source_, soup_.facets.size());
    const auto first = static_cast<std::uint32_t>(3 * soup_.facets.size());
    soup_.facets.push_back({first, first + 1, first + 2});
  }

  void emit_fan() {
    const std::vector<Vec3> loop(soup_.points.begin() + static_cast<std::ptrdiff_t>(loop_start_),
                                 soup_.points.end());
    soup_.points.resize(loop_start_);
    for (std::size_t i = 2; i < loop.size(); ++i) {
      soup_.points.insert(soup_.points.end(), {loop[0], loop[i - 1], loop[i]});
      emit_facet();
    }
  }

  void drop_facet(std::size_t corners) {
    if (!source_.salvage)
      source_.fail_at(facet_at_, fmt::format("expected a facet of 3 vertices, found {}", corners),
                      kFacetHint);
    soup_.points.resize(loop_start_);
    dropped_.add(facet_at_);
  }

  std::uint32_t facet_count() const { return static_cast<std::uint32_t>(soup_.facets.size()); }

  // Ends the run of facets of the last solid; a solid without facets leaves no run.
  void close_group() {
    if (soup_.groups.empty()) {
      if (facet_count() > 0) soup_.groups.push_back({"", 0, facet_count()});
      return;
    }
    FacetGroup& last = soup_.groups.back();
    last.facet_count = facet_count() - last.first_facet;
    if (last.facet_count == 0) soup_.groups.pop_back();
  }

  void finish() {
    if (facet_at_ && !source_.salvage)
      source_.fail_at(source_.end(), "truncated: the file ends within a facet");
    close_facet();
    close_group();
  }

  void warn(std::vector<std::string>& out, const Tally& tally, std::string_view noun,
            std::string_view what) const {
    if (tally.count() == 0) return;
    out.push_back(fmt::format("{} {}, the first at {}", counted(tally.count(), noun), what,
                              source_.place(tally.first())));
  }

  std::vector<std::string> warnings() const {
    std::vector<std::string> told_warnings;
    warn(told_warnings, many_vertices_, "facet", "with more than three vertices cut into triangles");
    warn(told_warnings, dropped_, "broken facet", "left out");
    warn(told_warnings, decimal_commas_, "number", "read with a decimal comma");
    warn(told_warnings, odd_words_, "word", "that an STL does not have ignored");
    if (in_solid_) told_warnings.push_back("the file ends without 'endsolid': it may have been cut off");
    return told_warnings;
  }

  const Source& source_;
  TextScanner scan_;
  TriangleSoup soup_;
  const char* facet_at_ = nullptr;  // where the open facet begins
  std::size_t loop_start_ = 0;      // the open loop's corners are the points from here on
  bool facet_has_loop_ = false;
  bool loop_is_broken_ = false;
  bool in_solid_ = false;
  Tally many_vertices_, dropped_, decimal_commas_, odd_words_;
};

}  // namespace

MeshFile read_stl_ascii(const Source& source) { return AsciiStlReader(source).read(); }

}  // namespace burnish
