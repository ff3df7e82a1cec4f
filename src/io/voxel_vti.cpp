// Reading .vti: VTK's ImageData in XML, as "VTK XML Formats" of its documentation describes them.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "text_scanner.h"
#include "voxel_array.h"
#include "xml_tags.h"

namespace burnish::detail {
namespace {

constexpr std::int64_t kMostNodes = std::int64_t{1} << 31;  // along an axis

enum class Section { none, points, cells };
enum class Encoding { ascii, base64, raw };

struct Array {
  Section section = Section::none;
  std::string name;
  std::string type, format;
  std::string components;
  std::string offset;
  std::string_view text;  // inline
  const char* at = nullptr;
};

// Bytes behind an encoding.
struct EncodedBytes {
  std::string_view text;
  Encoding encoding;

  // The first `size` bytes at most.
  std::string_view first(std::size_t size, std::string& buffer) const {
    if (encoding == Encoding::raw) return text.substr(0, size);
    buffer = decode_base64(text, size);
    return buffer;
  }
  // At least as many as there are.
  double most() const { return static_cast<double>(text.size()); }
};

template <class T, std::size_t N>
std::optional<std::array<T, N>> numbers_in(std::string_view text) {
  std::array<T, N> numbers;
  TextScanner scan(text);
  for (T& number : numbers) {
    const std::string_view word = scan.word();
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  }
  return scan.at_end() ? std::optional(numbers) : std::nullopt;
}

std::optional<VoxelType> type_named(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, VoxelType>, 10> kTypes{
      {{"UInt8", VoxelType::uint8}, {"Int8", VoxelType::int8}, {"UInt16", VoxelType::uint16}, {"Int16", VoxelType::int16}, {"UInt32", VoxelType::uint32},
       {"Int32", VoxelType::int32}, {"UInt64", VoxelType::uint64}, {"Int64", VoxelType::int64}, {"Float32", VoxelType::float32}, {"Float64", VoxelType::float64}}};
  for (const auto& [name, value] : kTypes)
    if (name == type) return value;
  return std::nullopt;
}

class VtiReader {
 public:
  VtiReader(const Source& source, std::uint64_t memory, Progress& progress) : source_(source), tags_(source), memory_(memory), progress_(progress) {}

  VoxelVolume read(const std::string& wanted) {
    scan();
    const Array& array = chosen(wanted);
    VoxelVolume volume = geometry(array);
    const auto type = type_named(array.type);
    if (!type) source_.fail_at(array.at, fmt::format("expected a type such as UInt16 or Float32, found {}", quoted(array.type)), kVoxelHint);
    require_places(source_, volume);
    volume.type = *type;
    volume.name = array.name;
    fill(array, volume);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (is_reversed_[axis]) reverse_axis(volume, axis);
    return volume;
  }

 private:
  std::string required(const XmlTag& tag, std::string_view attribute) const {
    if (auto value = tag.value(attribute)) return *value;
    source_.fail_at(tag.at, fmt::format("<{}> has no attribute {}", tag.name, attribute), kVoxelHint);
  }

  // All tags up to the appended data.
  void scan() {
    while (const auto tag = tags_.next()) {
      if (tag->name == "PointData" || tag->name == "CellData") begin_section(*tag);
      if (tag->is_end) continue;
      if (tag->name == "VTKFile") read_file_tag(*tag);
      if (tag->name == "ImageData") read_image_tag(*tag);
      if (tag->name == "Piece") read_piece_tag(*tag);
      if (tag->name == "DataArray") read_array_tag(*tag);
      if (tag->name == "AppendedData") return read_appended_tag(*tag);
    }
  }

  void begin_section(const XmlTag& tag) {
    section_ = tag.is_end || tag.is_empty ? Section::none : tag.name == "PointData" ? Section::points : Section::cells;
    if (tag.is_end) return;
    if (const auto scalars = tag.value("Scalars"); scalars && active_.empty()) active_ = *scalars;
  }

  void read_file_tag(const XmlTag& tag) {
    const std::string type = required(tag, "type");
    if (type != "ImageData") source_.fail_at(tag.at, fmt::format("expected a file of ImageData, found {}", quoted(type)), "resample it to an image, in ParaView for example");
    is_vtk_ = true;
    big_endian_ = tag.value("byte_order").value_or("LittleEndian") == "BigEndian";
    const std::string header = tag.value("header_type").value_or("UInt32");
    if (header != "UInt32" && header != "UInt64") source_.fail_at(tag.at, fmt::format("expected a header_type of UInt32 or UInt64, found {}", quoted(header)), kVoxelHint);
    word_ = header == "UInt64" ? 8 : 4;
    const std::string compressor = tag.value("compressor").value_or("");
    is_compressed_ = !compressor.empty();
    if (is_compressed_ && compressor != "vtkZLibDataCompressor")
      source_.fail_at(tag.at, fmt::format("expected data compressed by zlib, or not at all; found {}", quoted(compressor)), "write the file with zlib, the default of VTK");
  }

  void read_image_tag(const XmlTag& tag) {
    const std::string extent = required(tag, "WholeExtent");
    extent_ = extent_of(tag, extent);
    origin_ = vector_of(tag, "Origin", {0, 0, 0});
    spacing_ = vector_of(tag, "Spacing", {1, 1, 1});
    const auto direction = tag.value("Direction");
    if (!direction) return;
    const auto d = numbers_in<double, 9>(*direction);
    for (std::size_t i = 0; d && i < 9; ++i)
      if (std::abs(std::abs((*d)[i]) - (i % 4 == 0 ? 1 : 0)) > 1e-6) return refuse_direction(tag, *direction);
    if (!d) return refuse_direction(tag, *direction);
    for (int axis = 0; axis < 3; ++axis) spacing_[axis] *= (*d)[4 * static_cast<std::size_t>(axis)];
  }

  void refuse_direction(const XmlTag& tag, const std::string& direction) const {
    source_.fail_at(tag.at, fmt::format("expected axes parallel to the coordinates', found Direction={}", quoted(direction)), "resample the volume");
  }

  std::array<std::int64_t, 6> extent_of(const XmlTag& tag, const std::string& text) const {
    const auto extent = numbers_in<std::int64_t, 6>(text);
    bool good = extent.has_value();
    for (std::size_t a = 0; good && a < 6; a += 2) {
      const std::int64_t low = (*extent)[a], high = (*extent)[a + 1];
      good = low > -kMostNodes && high >= low && high < kMostNodes;
    }
    if (!good) source_.fail_at(tag.at, fmt::format("expected an extent of six whole numbers, from and to along each axis; found {}", quoted(text)), kVoxelHint);
    return *extent;
  }

  Vec3 vector_of(const XmlTag& tag, std::string_view attribute, const Vec3& otherwise) const {
    const auto text = tag.value(attribute);
    if (!text) return otherwise;
    const auto v = numbers_in<double, 3>(*text);
    if (!v || !std::all_of(v->begin(), v->end(), [](double x) { return std::isfinite(x); }))
      source_.fail_at(tag.at, fmt::format("expected three finite numbers as {}, found {}", attribute, quoted(*text)), kVoxelHint);
    return {(*v)[0], (*v)[1], (*v)[2]};
  }

  void read_piece_tag(const XmlTag& tag) {
    if (++pieces_ > 1 || extent_of(tag, required(tag, "Extent")) != extent_)
      source_.fail_at(tag.at, "expected one piece that is the whole image, found a part of it", "write the image as one piece");
  }

  void read_array_tag(const XmlTag& tag) {
    Array array{section_, tag.value("Name").value_or(""), required(tag, "type"), tag.value("format").value_or("ascii"), tag.value("NumberOfComponents").value_or("1"),
                tag.value("offset").value_or(""), {}, tag.at};
    if (!tag.is_empty) {
      // Keys may stand before or behind the numbers.
      array.text = tags_.text();
      for (auto inner = tags_.next(); inner && !(inner->is_end && inner->name == "DataArray"); inner = tags_.next())
        if (tags_.text().size() > array.text.size()) array.text = tags_.text();
    }
    if (section_ != Section::none) arrays_.push_back(std::move(array));
  }

  void read_appended_tag(const XmlTag& tag) {
    const std::string encoding = tag.value("encoding").value_or("base64");
    if (encoding != "raw" && encoding != "base64") source_.fail_at(tag.at, fmt::format("expected an encoding raw or base64, found {}", quoted(encoding)), kVoxelHint);
    const std::string_view rest(tags_.position(), static_cast<std::size_t>(source_.end() - tags_.position()));
    const std::size_t mark = rest.find('_');
    if (mark == rest.npos) source_.fail_at(tag.at, "expected '_' before the appended data", kVoxelHint);
    appended_ = {rest.substr(mark + 1), encoding == "raw" ? Encoding::raw : Encoding::base64};
  }

  const Array& chosen(const std::string& wanted) const {
    if (!is_vtk_ || pieces_ == 0) source_.fail("expected VTK's XML with a piece of an image", kVoxelHint);
    const auto named = [&](const std::string& name) { return std::find_if(arrays_.begin(), arrays_.end(), [&](const Array& a) { return a.name == name; }); };
    auto found = named(wanted.empty() ? active_ : wanted);
    if (found == arrays_.end() && wanted.empty()) found = std::find_if(arrays_.begin(), arrays_.end(), [](const Array& a) { return a.components == "1"; });
    if (found == arrays_.end()) refuse_choice(wanted);
    if (found->components != "1") source_.fail_at(found->at, fmt::format("expected an array of one component, found {} of {}", quoted(found->name), quoted(found->components)), "choose one with --array NAME");
    return *found;
  }

  [[noreturn]] void refuse_choice(const std::string& wanted) const {
    std::string names;
    for (const Array& a : arrays_) names += (names.empty() ? "" : ", ") + quoted(a.name);
    source_.fail(fmt::format("expected {}, found {}", wanted.empty() ? "an array of one component" : "an array " + quoted(wanted), names.empty() ? "no array" : names),
                 "choose one with --array NAME");
  }

  VoxelVolume geometry(const Array& array) {
    VoxelVolume volume;
    const bool in_cells = array.section == Section::cells;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const std::int64_t cells = extent_[2 * a + 1] - extent_[2 * a];
      const double spacing = spacing_[axis];
      volume.nodes[a] = static_cast<std::uint32_t>(in_cells ? cells : cells + 1);
      if (spacing == 0 || !(std::abs(spacing) < kLargestLength)) source_.fail(fmt::format("expected a spacing other than 0, found {}", spacing), kVoxelHint);
      volume.spacing[axis] = std::abs(spacing);
      is_reversed_[a] = spacing < 0;
      const double first = static_cast<double>(extent_[2 * a]) + (in_cells ? 0.5 : 0), last = first + static_cast<double>(volume.nodes[a]) - 1;
      volume.origin[axis] = origin_[axis] + spacing * (is_reversed_[a] ? last : first);
    }
    return volume;
  }

  void fill(const Array& array, VoxelVolume& volume) {
    const double size = static_cast<double>(size_of(volume.type));
    if (array.format == "ascii") {
      volume.values.resize(checked_count(source_, volume.nodes, static_cast<double>(array.text.size()) + 1, 2, memory_));
      return read_words(source_, array.text, volume.values, progress_);
    }
    const EncodedBytes bytes = bytes_of(array);
    volume.values.resize(checked_count(source_, volume.nodes, bytes.most() * (is_compressed_ ? kMostInflation : 1), size, memory_));
    const NumberLayout layout{volume.type, big_endian_};
    if (is_compressed_) return read_blocks(bytes, layout, volume.values);
    std::string buffer;
    const std::size_t needed = volume.size() * size_of(volume.type);
    const std::string_view data = bytes.first(word_ + needed, buffer);
    if (data.size() < word_ || word_at(data, 0) != needed)
      source_.fail_at(array.at, fmt::format("expected {} bytes of data, found {}", needed, data.size() < word_ ? 0 : word_at(data, 0)), kVoxelHint);
    read_raw(source_, data.substr(word_), layout, volume.values);
  }

  EncodedBytes bytes_of(const Array& array) const {
    if (array.format == "binary") return {array.text, Encoding::base64};
    if (array.format != "appended") source_.fail_at(array.at, fmt::format("expected the format ascii, binary or appended, found {}", quoted(array.format)), kVoxelHint);
    const auto offset = numbers_in<std::uint64_t, 1>(array.offset);
    if (!offset || (*offset)[0] > appended_.text.size())
      source_.fail_at(array.at, fmt::format("expected an offset into the {} bytes of appended data, found {}", appended_.text.size(), quoted(array.offset)), kVoxelHint);
    return {appended_.text.substr((*offset)[0]), appended_.encoding};
  }

  std::uint64_t word_at(std::string_view bytes, std::size_t i) const {
    std::array<unsigned char, 8> b{};
    std::memcpy(b.data(), bytes.data() + i * word_, word_);
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < word_; ++k) value = value << 8 | b[big_endian_ ? k : word_ - 1 - k];
    return value;
  }

  [[noreturn]] void refuse_blocks(const std::string& found) const { source_.fail("expected blocks of compressed data, found " + found, kVoxelHint); }

  // Their count, their size, that of the last one if it is shorter, the size of each once compressed; the blocks.
  void read_blocks(const EncodedBytes& bytes, NumberLayout layout, std::span<float> to) const {
    std::string buffer;
    const std::uint64_t needed = to.size() * size_of(layout.type);
    std::string_view head = bytes.first(3 * word_, buffer);
    if (head.size() < 3 * word_) refuse_blocks("the end of the data");
    const std::uint64_t count = word_at(head, 0), side = word_at(head, 1), last = word_at(head, 2);
    if (count == 0 || count > bytes.text.size() || side == 0 || side % size_of(layout.type) != 0 || last > side || count > needed / side + 1 ||
        (count - 1) * side + (last ? last : side) != needed)
      refuse_blocks(fmt::format("{} of {} bytes and {} of the last one, for {} bytes", count, side, last, needed));
    head = bytes.first((3 + count) * word_, buffer);
    if (head.size() < (3 + count) * word_) refuse_blocks("the end of the data");
    const std::vector<std::uint64_t> first = starts_of(head, count, bytes.text.size());
    const std::string_view data = bytes.first(first.back(), buffer);
    if (data.size() < first.back()) refuse_blocks("the end of the data");
    inflate_blocks(data, first, side, layout, to);
  }

  std::vector<std::uint64_t> starts_of(std::string_view head, std::uint64_t count, std::uint64_t most) const {
    std::vector<std::uint64_t> first{(3 + count) * word_};
    for (std::size_t b = 0; b < count; ++b) {
      const std::uint64_t size = word_at(head, 3 + b);
      if (size > most - std::min(most, first.back())) refuse_blocks(fmt::format("one of {} bytes in {}", size, most));
      first.push_back(first.back() + size);
    }
    return first;
  }

  void inflate_blocks(std::string_view data, const std::vector<std::uint64_t>& first, std::uint64_t side, NumberLayout layout, std::span<float> to) const {
    const std::size_t per_block = side / size_of(layout.type), count = first.size() - 1;
    std::vector<char> is_bad(count, 0);
    parallel_for(count, [&](std::size_t b) {
      progress_.check();
      const std::span<float> part = to.subspan(b * per_block, std::min(per_block, to.size() - b * per_block));
      std::vector<char> bytes(part.size() * size_of(layout.type));
      uLongf size = bytes.size();
      const int status = ::uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(data.data() + first[b]), first[b + 1] - first[b]);
      is_bad[b] = status != Z_OK || size != bytes.size();
      if (!is_bad[b]) unpack(layout, bytes.data(), part);
    }, 1);
    const auto bad = std::find(is_bad.begin(), is_bad.end(), 1);
    if (bad != is_bad.end()) refuse_blocks(fmt::format("damaged ones: block {} of {} is the first", bad - is_bad.begin() + 1, count));
  }

  const Source& source_;
  XmlTags tags_;
  std::uint64_t memory_;
  Progress& progress_;

  bool is_vtk_ = false, big_endian_ = false, is_compressed_ = false;
  std::size_t word_ = 4;  // bytes of a number in headers
  std::array<std::int64_t, 6> extent_{};
  Vec3 origin_, spacing_{1, 1, 1};
  std::array<bool, 3> is_reversed_{};
  int pieces_ = 0;
  Section section_ = Section::none;
  std::string active_;
  std::vector<Array> arrays_;
  EncodedBytes appended_{{}, Encoding::raw};
};

}  // namespace

VoxelVolume read_vti(const Source& source, const std::string& array, std::uint64_t memory, Progress& progress) {
  return VtiReader(source, memory, progress).read(array);
}

}  // namespace burnish::detail
