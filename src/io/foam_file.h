// The files of an OpenFOAM case as text and lists: entries of dictionaries, numbers, lists in text or in binary.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/io/foam_case.h"
#include "mapped_file.h"
#include "source.h"

namespace burnish {

inline constexpr std::string_view kMeshHint = "write the mesh again with the tool that made it; OpenFOAM's checkMesh tells what else is wrong";
inline constexpr std::string_view kCutOffHint = "the file was cut off: copy it again";

// All members of a gzip file. Throws Error{unreadable_input} if it is broken, or holds more than `most` bytes.
std::string unpack_gzip(std::string_view packed, const std::string& label, std::size_t most);

// The bytes of `path`, or of `path`.gz, unpacked.
class FoamFile {
 public:
  // Throws Error{unreadable_input} if neither is there.
  explicit FoamFile(const std::string& path);
  static bool exists(const std::string& path);

  // Where they came from, with its suffix.
  const std::string& path() const { return path_; }
  bool compressed() const { return compressed_; }
  std::string_view bytes() const { return compressed_ ? std::string_view(unpacked_) : mapped_->bytes(); }

 private:
  std::string path_;
  bool compressed_ = false;
  std::unique_ptr<MappedFile> mapped_;
  std::string unpacked_;
};

// `name value;` or `name { ... }`. Views into the text.
struct FoamEntry {
  std::string_view name;   // quotes included
  std::string_view value;  // without what surrounds it: between name and ';', or between the braces
  bool is_dictionary = false;
};

// The entries of a text, in order: of a whole file (also one that ends behind the name of an entry) or of a dictionary's value. Directives (`#include`)
// and macros on their own are passed over. `text` lies within the source. Lists in binary are passed over by their sizes.
std::vector<FoamEntry> foam_entries(const Source& source, std::string_view text, const FoamFormat& format);
// The last of that name, as OpenFOAM takes it, or none.
const FoamEntry* find_entry(const std::vector<FoamEntry>& entries, std::string_view name);

struct FoamHeader {
  std::string class_name;
  FoamFormat format;
  const char* end = nullptr;  // behind its brace
};
// The dictionary FoamFile that a file begins with. Throws Error{unreadable_input} if there is none, or if its bytes are not ours.
FoamHeader foam_header(Source& source, bool compressed);
// The same as text, for a new file. `entries`: further lines of it, each with its end.
std::string foam_header_text(std::string_view class_name, std::string_view object, const FoamFormat& format, std::string_view entries = {});
// Types of patches that fields have no choice at: their conditions have the same name.
bool is_constraint(std::string_view patch_type);

// Numbers, punctuation and lists, one after the other.
class FoamScanner {
 public:
  FoamScanner(const Source& source, const FoamFormat& format, const char* from) : source_(source), format_(format), at_(from), end_(source.end()) {}

  const char* position() const { return at_; }
  // Blanks and comments.
  void skip() {
    while (at_ < end_) {
      if (static_cast<unsigned char>(*at_) <= ' ')
        ++at_;
      else if (*at_ != '/' || !skip_comment())
        return;
    }
  }
  bool accept(char c) {
    skip();
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  void expect(char c, std::string_view where);
  // A word without blanks, brackets or semicolons.
  std::string_view word();
  // A number of things of at least `bytes` bytes each in text, or -1: in binary, label_bytes.
  std::size_t count(std::string_view of);

  std::vector<Vec3> points();
  // Of values below `bound`; a list of another length than `size` (unless that is empty) is an error. `what` is what values are: "cell".
  std::vector<std::uint32_t> labels(std::optional<std::size_t> size, std::uint64_t bound, std::string_view what);
  // Appends the values of one face.
  void face(std::vector<std::uint32_t>& to, std::uint64_t bound);
  bool binary() const { return format_.binary; }

  [[noreturn]] void fail(const std::string& message, std::string_view hint = kMeshHint) const { source_.fail_at(at_, message, hint); }
  // What stands here, for a message.
  std::string found() const;

 private:
  bool skip_comment();
  std::uint64_t label(std::string_view what);
  double number();
  // The bytes of a list in binary, between its brackets.
  const char* block(std::size_t count, std::size_t bytes_each, std::string_view what);
  std::uint32_t checked(std::uint64_t value, std::uint64_t bound, std::string_view what) const;
  std::uint64_t raw_label(const char* from) const;
  double raw_scalar(const char* from) const;

  const Source& source_;
  FoamFormat format_;
  const char* at_;
  const char* end_;
};

}  // namespace burnish
