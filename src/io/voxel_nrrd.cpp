// Reading .nrrd and .nhdr, as "Definition of NRRD File Format" (teem.sourceforge.net/nrrd/format.html) says.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "mapped_file.h"
#include "text_scanner.h"
#include "voxel_array.h"

namespace burnish::detail {
namespace {

constexpr double kParallel = 1e-6;  // of an axis' length: what it may be off a coordinate's direction
constexpr std::size_t kMostAxes = 4;

struct Line {
  std::string_view value;
  const char* at = nullptr;
};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
  return result;
}

// Names that mean the same.
std::string field_named(std::string_view text) {
  static const std::map<std::string, std::string> kSame{{"centerings", "centers"}, {"datafile", "data file"}, {"lineskip", "line skip"}, {"byteskip", "byte skip"}, {"axismins", "axis mins"}, {"axismaxs", "axis maxs"}};
  const std::string name = lower(text);
  const auto same = kSame.find(name);
  return same == kSame.end() ? name : same->second;
}

std::optional<VoxelType> type_named(std::string_view type) {
  static const std::map<std::string, VoxelType> kTypes{
      {"signed char", VoxelType::int8}, {"int8", VoxelType::int8}, {"int8_t", VoxelType::int8},
      {"uchar", VoxelType::uint8}, {"unsigned char", VoxelType::uint8}, {"uint8", VoxelType::uint8}, {"uint8_t", VoxelType::uint8},
      {"short", VoxelType::int16}, {"short int", VoxelType::int16}, {"signed short", VoxelType::int16}, {"signed short int", VoxelType::int16}, {"int16", VoxelType::int16}, {"int16_t", VoxelType::int16},
      {"ushort", VoxelType::uint16}, {"unsigned short", VoxelType::uint16}, {"unsigned short int", VoxelType::uint16}, {"uint16", VoxelType::uint16}, {"uint16_t", VoxelType::uint16},
      {"int", VoxelType::int32}, {"signed int", VoxelType::int32}, {"int32", VoxelType::int32}, {"int32_t", VoxelType::int32},
      {"uint", VoxelType::uint32}, {"unsigned int", VoxelType::uint32}, {"uint32", VoxelType::uint32}, {"uint32_t", VoxelType::uint32},
      {"longlong", VoxelType::int64}, {"long long", VoxelType::int64}, {"long long int", VoxelType::int64}, {"signed long long", VoxelType::int64}, {"signed long long int", VoxelType::int64},
      {"int64", VoxelType::int64}, {"int64_t", VoxelType::int64},
      {"ulonglong", VoxelType::uint64}, {"unsigned long long", VoxelType::uint64}, {"unsigned long long int", VoxelType::uint64}, {"uint64", VoxelType::uint64}, {"uint64_t", VoxelType::uint64},
      {"float", VoxelType::float32}, {"double", VoxelType::float64}};
  const auto found = kTypes.find(lower(type));
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

class NrrdReader {
 public:
  NrrdReader(const Source& source, const std::optional<std::string>& folder, std::uint64_t memory, Progress& progress)
      : source_(source), folder_(folder), memory_(memory), progress_(progress) {}

  VoxelVolume read() {
    read_header();
    choose_axes();
    VoxelVolume volume;
    const Line type = required("type");
    const auto number = type_named(type.value);
    if (!number) source_.fail_at(type.at, fmt::format("expected a type such as 'unsigned short' or 'float', found {}", quoted(type.value)), kVoxelHint);
    volume.type = *number;
    if (has("content")) volume.name = std::string(lines_.at("content").value);
    for (std::size_t a = 0; a < 3; ++a) volume.nodes[a] = static_cast<std::uint32_t>(sizes_[axes_[a]]);
    place_axes(volume);
    require_places(source_, volume);
    fill(volume);
    for (std::size_t a = 0; a < 3; ++a)
      if (is_reversed_[a]) reverse_axis(volume, a);
    return volume;
  }

 private:
  bool has(const std::string& field) const { return lines_.contains(field); }
  Line required(const std::string& field) const {
    if (has(field)) return lines_.at(field);
    source_.fail(fmt::format("expected a line '{}: ...' in the header, found none", field), kVoxelHint);
  }

  std::string_view next_line(std::string_view& rest) const {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  // Up to the empty line, behind which attached data stand.
  void read_header() {
    std::string_view rest = source_.bytes;
    const std::string_view magic = next_line(rest);
    if (!magic.starts_with("NRRD000")) source_.fail(fmt::format("expected a first line such as NRRD0004, found {}", quoted(magic)), kVoxelHint);
    while (!rest.empty()) {
      const std::string_view line = next_line(rest);
      if (line.empty()) break;
      if (line.starts_with('#')) continue;
      const std::size_t colon = line.find(':');
      if (colon == line.npos) source_.fail_at(line.data(), fmt::format("expected 'field: value', found {}", quoted(line)), kVoxelHint);
      if (line.substr(colon).starts_with(":=")) continue;
      TextScanner value(line.substr(colon + 1));
      lines_[field_named(line.substr(0, colon))] = {value.rest_of_line(), line.data()};
    }
    attached_ = rest;
  }

  std::int64_t whole(const std::string& field, std::int64_t otherwise) const {
    if (!has(field)) return otherwise;
    std::int64_t number = 0;
    const Line line = lines_.at(field);
    const auto [end, error] = std::from_chars(line.value.data(), line.value.data() + line.value.size(), number);
    if (error != std::errc() || end != line.value.data() + line.value.size())
      source_.fail_at(line.at, fmt::format("expected a whole number as {}, found {}", field, quoted(line.value)), kVoxelHint);
    return number;
  }

  // Three axes of those in the file: of four, one has length 1.
  void choose_axes() {
    const std::int64_t dimension = whole("dimension", 0);
    const Line sizes = required("sizes");
    if (dimension != 3 && dimension != 4) source_.fail_at(required("dimension").at, fmt::format("expected three axes, or four with one of length 1, found {}", dimension), kVoxelHint);
    TextScanner scan(sizes.value);
    for (std::int64_t a = 0; a < dimension; ++a) {
      const auto size = whole_number(scan.word());
      if (!size || !(*size >= 1 && *size < 0x1p32 - 1) || *size != std::floor(*size))
        source_.fail_at(sizes.at, fmt::format("expected {} sizes of at least 1, found {}", dimension, quoted(sizes.value)), kVoxelHint);
      sizes_.push_back(static_cast<std::uint64_t>(*size));
    }
    if (!scan.at_end()) source_.fail_at(sizes.at, fmt::format("expected {} sizes, found {}", dimension, quoted(sizes.value)), kVoxelHint);
    read_directions();
    std::size_t left_out = kMostAxes;
    for (std::size_t a = sizes_.size(); dimension == 4 && a-- > 0;)
      if (sizes_[a] == 1 && (left_out == kMostAxes || !directions_[a])) left_out = a;
    if (dimension == 4 && left_out == kMostAxes) source_.fail_at(sizes.at, fmt::format("expected four axes with one of length 1, found {}", quoted(sizes.value)), "take one component of the values");
    std::size_t next = 0;
    for (std::size_t a = 0; a < sizes_.size(); ++a)
      if (a != left_out) axes_[next++] = a;
  }

  // A vector of three numbers such as (1,0,0.5); nothing for "none".
  std::optional<Vec3> vector_at(const Line& line, std::string_view& rest) const {
    const auto bad = [&]() { source_.fail_at(line.at, fmt::format("expected vectors such as (1,0,0), found {}", quoted(line.value)), kVoxelHint); };
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (rest.starts_with("none")) return rest.remove_prefix(4), std::nullopt;
    const std::size_t close = rest.find(')');
    if (!rest.starts_with('(') || close == rest.npos) bad();
    std::string inside(rest.substr(1, close - 1));
    rest.remove_prefix(close + 1);
    std::replace(inside.begin(), inside.end(), ',', ' ');
    TextScanner scan(inside);
    Vec3 v;
    for (int a = 0; a < 3; ++a) {
      double x = 0;
      if (!scan.number(x) || !(std::abs(x) < kLargestLength)) bad();
      v[a] = x;
    }
    if (!scan.at_end()) bad();
    return v;
  }

  void read_directions() {
    directions_.assign(sizes_.size(), std::nullopt);
    if (!has("space directions")) return;
    const Line line = lines_.at("space directions");
    std::string_view rest = line.value;
    for (auto& direction : directions_) direction = vector_at(line, rest);
  }

  // The numbers of a line, one for each axis of the file; `otherwise` without the line and for NaN.
  std::vector<double> per_axis(const std::string& field, double otherwise) const {
    std::vector<double> numbers(sizes_.size(), otherwise);
    if (!has(field)) return numbers;
    const Line line = lines_.at(field);
    TextScanner scan(line.value);
    for (double& number : numbers) {
      const auto found = whole_number(scan.word());
      if (!found || std::abs(*found) > kLargestLength) source_.fail_at(line.at, fmt::format("expected {} numbers as {}, found {}", numbers.size(), field, quoted(line.value)), kVoxelHint);
      if (!std::isnan(*found)) number = *found;
    }
    return numbers;
  }

  void place_axes(VoxelVolume& volume) {
    const bool has_directions = has("space directions");
    const std::vector<double> mins = per_axis("axis mins", 0), spacings = has("spacings") ? per_axis("spacings", 1) : spacings_between(mins);
    Vec3 origin;
    if (has("space origin")) {
      const Line line = lines_.at("space origin");
      std::string_view rest = line.value;
      if (const auto v = vector_at(line, rest)) origin = *v;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t file_axis = axes_[static_cast<std::size_t>(axis)];
      const double step = has_directions ? along(axis, directions_[file_axis]) : spacings[file_axis];
      if (step == 0) source_.fail("expected spacings other than 0, and ends of axes that differ", kVoxelHint);
      const double half = has("axis mins") && is_cell_centered(file_axis) ? 0.5 * step : 0;
      const bool is_reversed = is_reversed_[static_cast<std::size_t>(axis)] = step < 0;
      const double first = origin[axis] + (has_directions ? 0 : mins[file_axis] + half);
      volume.spacing[axis] = std::abs(step);
      volume.origin[axis] = is_reversed ? first + step * (static_cast<double>(sizes_[file_axis]) - 1) : first;
    }
  }

  // Of axes of which only the ends are known: those of their cells, or their outermost samples.
  std::vector<double> spacings_between(const std::vector<double>& mins) const {
    std::vector<double> spacings(sizes_.size(), 1);
    if (!has("axis mins") || !has("axis maxs")) return spacings;
    const std::vector<double> maxs = per_axis("axis maxs", 0);
    for (std::size_t a = 0; a < spacings.size(); ++a) {
      const double steps = static_cast<double>(sizes_[a]) - (is_cell_centered(a) ? 0 : 1);
      if (steps > 0) spacings[a] = (maxs[a] - mins[a]) / steps;
    }
    return spacings;
  }

  double along(int axis, const std::optional<Vec3>& direction) const {
    const Line line = lines_.at("space directions");
    if (!direction) source_.fail_at(line.at, "expected directions of three axes in space", kVoxelHint);
    for (int other = 0; other < 3; ++other)
      if (other != axis && std::abs((*direction)[other]) > kParallel * std::abs((*direction)[axis]))
        source_.fail_at(line.at, fmt::format("expected axes x, y and z parallel to the coordinates', in that order; found {}", quoted(line.value)), "resample the volume along its axes");
    return (*direction)[axis];
  }

  bool is_cell_centered(std::size_t file_axis) const {
    if (!has("centers")) return false;
    TextScanner scan(lines_.at("centers").value);
    for (std::size_t a = 0; a < file_axis; ++a) scan.word();
    return lower(scan.word()) == "cell";
  }

  // The data, and the file that holds them if that is another one.
  std::string_view data_bytes() {
    if (!has("data file")) return attached_;
    const Line line = lines_.at("data file");
    if (line.value.find('%') != line.value.npos || line.value.starts_with("LIST"))
      source_.fail_at(line.at, fmt::format("expected one file of data, found {}", quoted(line.value)), "write all slices into one file");
    if (!folder_) source_.fail_at(line.at, "the data stand in another file", "give the file itself, not a stream of it");
    const std::string path = line.value.starts_with('/') ? std::string(line.value) : *folder_ + std::string(line.value);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) source_.fail_at(line.at, fmt::format("the data file {} is not there, or is none", burnish::quoted(path)), "put it beside its header");
    detached_ = std::make_unique<MappedFile>(path);
    detached_path_ = path;
    return detached_->bytes();
  }

  void fill(VoxelVolume& volume) {
    std::string_view bytes = data_bytes();
    const Source data{detached_ ? detached_->bytes() : source_.bytes, detached_ ? detached_path_ : source_.label, false, false};
    for (std::int64_t n = whole("line skip", 0); n > 0 && !bytes.empty(); --n) next_line(bytes);
    const std::int64_t skip = whole("byte skip", 0);
    const std::string encoding = lower(required("encoding").value);
    const bool is_text = encoding == "ascii" || encoding == "text" || encoding == "txt", is_gzip = encoding == "gzip" || encoding == "gz";
    const std::size_t size = size_of(volume.type);
    if (!is_text && !is_gzip && encoding != "raw")
      source_.fail_at(required("encoding").at, fmt::format("expected the encoding raw, gzip or ascii, found {}", burnish::quoted(encoding)), "write it with gzip");
    if (skip < 0 && (skip != -1 || encoding != "raw")) source_.fail_at(required("byte skip").at, "expected a number of bytes, or -1 for raw data", kVoxelHint);
    const double most = is_text ? 0.5 * (static_cast<double>(bytes.size()) + 1) : static_cast<double>(bytes.size()) * (is_gzip ? kMostInflation : 1) / static_cast<double>(size);
    volume.values.resize(checked_count(data, volume.nodes, most * static_cast<double>(size), static_cast<double>(size), memory_));
    const NumberLayout layout{volume.type, is_text || size == 1 ? false : is_big_endian()};
    if (is_gzip) return read_deflated(data, bytes, layout, static_cast<std::uint64_t>(skip), volume.values, progress_);
    const std::size_t needed = volume.size() * size;
    bytes.remove_prefix(skip < 0 ? bytes.size() - std::min(bytes.size(), needed) : std::min(bytes.size(), static_cast<std::size_t>(skip)));
    if (is_text) return read_words(data, bytes, volume.values, progress_);
    read_raw(data, bytes, layout, volume.values);
  }

  bool is_big_endian() const {
    const Line endian = required("endian");
    const std::string value = lower(endian.value);
    if (value != "little" && value != "big") source_.fail_at(endian.at, fmt::format("expected the endian little or big, found {}", burnish::quoted(value)), kVoxelHint);
    return value == "big";
  }

  const Source& source_;
  const std::optional<std::string>& folder_;
  std::uint64_t memory_;
  Progress& progress_;
  std::map<std::string, Line> lines_;
  std::string_view attached_;
  std::unique_ptr<MappedFile> detached_;
  std::string detached_path_;
  std::vector<std::uint64_t> sizes_;                   // of the file's axes
  std::vector<std::optional<Vec3>> directions_;        // of these
  std::array<std::size_t, 3> axes_{};                  // the file's axis behind x, y, z
  std::array<bool, 3> is_reversed_{};
};

}  // namespace

VoxelVolume read_nrrd(const Source& source, const std::optional<std::string>& folder, std::uint64_t memory, Progress& progress) {
  return NrrdReader(source, folder, memory, progress).read();
}

}  // namespace burnish::detail
