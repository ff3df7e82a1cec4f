// Writing .vti and .nrrd, a slab of layers at a time.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/voxel_volume.h"
#include "fd_writer.h"
#include "vtk_appended.h"

namespace burnish {
namespace {

constexpr std::size_t kSlab = std::size_t{1} << 22;    // values held at once, or one layer
constexpr std::size_t kPiece = std::size_t{1} << 18;   // bytes compressed at once
constexpr std::size_t kPieces = 64;
constexpr int kLevel = 1;  // as in vtk_appended.cpp

// Calls visit(values) for each slab in order.
template <class Visit>
void for_each_slab(const VoxelSource& source, Progress& progress, Visit&& visit) {
  const std::size_t layer = std::size_t{source.nodes[0]} * source.nodes[1];
  const auto layers = static_cast<std::uint32_t>(std::clamp<std::size_t>(kSlab / std::max<std::size_t>(layer, 1), 1, std::max<std::uint32_t>(source.nodes[2], 1)));
  std::vector<float> values;
  for (std::uint32_t first = 0; first < source.nodes[2]; first += layers) {
    progress.check();
    const std::uint32_t last = std::min(source.nodes[2], first + layers);
    values.resize(layer * (last - first));
    source.fill(first, last, values);
    visit(values);
    progress.update(static_cast<double>(last) / source.nodes[2]);
  }
}

std::string attribute(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return safe;
}

void write_vti(int fd, const std::string& label, const VoxelSource& source, Progress& progress) {
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", source.nodes[0] - 1, source.nodes[1] - 1, source.nodes[2] - 1);
  const std::size_t count = std::size_t{source.nodes[0]} * source.nodes[1] * source.nodes[2];
  const Vec3 &o = source.origin, &s = source.spacing;
  VtkAppended out(fd, label);
  out.text(R"(<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
)");
  out.text(fmt::format("  <ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\">\n    <Piece Extent=\"{}\">\n", extent, o.x, o.y, o.z, s.x, s.y, s.z, extent));
  out.text(fmt::format("      <PointData Scalars=\"{}\">\n", attribute(source.name)));
  out.announce("Float32", attribute(source.name), count);
  out.text("      </PointData>\n    </Piece>\n  </ImageData>\n");
  out.begin_data();
  out.begin_array(count * sizeof(float));
  for_each_slab(source, progress, [&](const std::vector<float>& values) { out.put(values.data(), values.size() * sizeof(float)); });
  out.end_array();
  out.finish();
}

// One gzip stream (RFC 1952) of pieces that are compressed in parallel: each ends on a byte without ending the stream, as pigz does it.
class GzipStream {
 public:
  explicit GzipStream(FdWriter& out) : out_(out) {
    constexpr std::array<unsigned char, 10> kHead{0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};  // no name, no time, any system
    out_.put({reinterpret_cast<const char*>(kHead.data()), kHead.size()});
  }

  void put(const char* bytes, std::size_t size) {
    for (std::size_t first = 0; first < size; first += kPieces * kPiece) put_batch(bytes + first, std::min(kPieces * kPiece, size - first));
  }

  void finish() {
    put_piece(deflated(nullptr, 0, Z_FINISH));
    out_.put_raw(static_cast<std::uint32_t>(check_));
    out_.put_raw(static_cast<std::uint32_t>(size_));
  }

 private:
  struct Piece {
    std::vector<Bytef> bytes;
    uLong check = 0;
    std::size_t size = 0;
  };

  static Piece deflated(const char* bytes, std::size_t size, int flush) {
    Piece piece{{}, ::crc32(0, reinterpret_cast<const Bytef*>(bytes), static_cast<uInt>(size)), size};
    z_stream z{};
    if (::deflateInit2(&z, kLevel, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw Error(ErrorCode::memory_limit, "zlib: not enough memory to compress a block", "free some memory, or choose fewer --samples");
    piece.bytes.resize(::deflateBound(&z, static_cast<uLong>(size)) + 16);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes));
    z.avail_in = static_cast<uInt>(size);
    z.next_out = piece.bytes.data();
    z.avail_out = static_cast<uInt>(piece.bytes.size());
    ::deflate(&z, flush);
    piece.bytes.resize(piece.bytes.size() - z.avail_out);
    ::deflateEnd(&z);
    return piece;
  }

  void put_batch(const char* bytes, std::size_t size) {
    std::vector<Piece> pieces((size + kPiece - 1) / kPiece);
    parallel_chunks(pieces.size(), [&](std::size_t p) { pieces[p] = deflated(bytes + p * kPiece, std::min(kPiece, size - p * kPiece), Z_SYNC_FLUSH); });
    for (const Piece& piece : pieces) put_piece(piece);
  }

  void put_piece(const Piece& piece) {
    out_.put({reinterpret_cast<const char*>(piece.bytes.data()), piece.bytes.size()});
    if (piece.size > 0) check_ = ::crc32_combine(check_, piece.check, static_cast<z_off_t>(piece.size));
    size_ += piece.size;
  }

  FdWriter& out_;
  uLong check_ = 0;
  std::size_t size_ = 0;
};

// A field's value ends with its line.
std::string on_one_line(std::string text) {
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

void write_nrrd(int fd, const std::string& label, const VoxelSource& source, Progress& progress) {
  const Vec3 &o = source.origin, &s = source.spacing;
  FdWriter out(fd, label);
  out.put("NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\n");
  if (!source.name.empty()) out.put("content: " + on_one_line(source.name) + "\n");
  out.put(fmt::format("sizes: {} {} {}\nspace directions: ({},0,0) (0,{},0) (0,0,{})\nspace origin: ({},{},{})\n", source.nodes[0], source.nodes[1], source.nodes[2], s.x, s.y, s.z, o.x, o.y, o.z));
  out.put("kinds: domain domain domain\nendian: little\nencoding: gzip\n\n");
  GzipStream gzip(out);
  for_each_slab(source, progress, [&](const std::vector<float>& values) { gzip.put(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)); });
  gzip.finish();
  out.flush();
}

}  // namespace

std::uint64_t bytes_to_write_voxels(const std::array<std::uint32_t, 3>& nodes) {
  constexpr std::uint64_t kCompressed = 2 * kPieces * kPiece;
  return std::max<std::uint64_t>(kSlab, std::uint64_t{nodes[0]} * nodes[1]) * sizeof(float) + kCompressed;
}

void write_voxels(int fd, const std::string& label, const VoxelSource& source, VoxelFormat format, Progress& progress) {
  if (format == VoxelFormat::vti) return write_vti(fd, label, source, progress);
  write_nrrd(fd, label, source, progress);
}

}  // namespace burnish
