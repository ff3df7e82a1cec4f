#include "zip_archive.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <optional>

#include "counts.h"

namespace burnish {
namespace {

constexpr std::string_view kLocal = "PK\x03\x04", kCentral = "PK\x01\x02", kEnd{"PK\x05\x06", 4};
constexpr std::size_t kLocalSize = 30, kCentralSize = 46, kEndSize = 22, kLongestComment = 0xffff;
constexpr std::uint32_t kInExtra = 0xffffffffu;  // a number that stands in the ZIP64 field
constexpr std::uint16_t kZip64Field = 1;
constexpr std::uint16_t kStored = 0, kDeflated = 8;
constexpr std::uint16_t kEncrypted = 1, kUtf8 = 0x0800;
constexpr std::uint16_t kVersion = 20, kDate = 0x0021;  // 1980-01-01, the first day that there is
constexpr std::size_t kPiece = std::size_t{1} << 16;
constexpr std::string_view kHint = "the file may be cut off: copy or export it again";

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::size_t find_end(const Source& source) {
  const std::string_view b = source.bytes;
  const std::size_t first = b.size() > kEndSize + kLongestComment ? b.size() - kEndSize - kLongestComment : 0;
  const std::size_t at = b.rfind(kEnd);
  if (at == b.npos || at < first || b.size() - at < kEndSize) source.fail("is a ZIP archive without its directory, which stands at the end", kHint);
  return at;
}

// Numbers that did not fit stand in the extra field, in this order, each only if it did not fit.
void read_zip64(std::string_view extra, ZipEntry& entry) {
  for (std::size_t at = 0; at + 4 <= extra.size();) {
    const std::size_t size = number_at<std::uint16_t>(extra, at + 2);
    if (number_at<std::uint16_t>(extra, at) == kZip64Field && at + 4 + size <= extra.size()) {
      std::size_t next = at + 4;
      for (std::uint64_t* value : {&entry.size, &entry.packed, &entry.header}) {
        if (*value != kInExtra || next + 8 > at + 4 + size) continue;
        *value = number_at<std::uint64_t>(extra, next);
        next += 8;
      }
      return;
    }
    at += 4 + size;
  }
}

// Reads the entry at `at` and moves behind it.
ZipEntry read_entry(const Source& source, std::size_t& at, std::size_t end) {
  const std::string_view b = source.bytes;
  if (at > end || end - at < kCentralSize || b.substr(at, 4) != kCentral) source.fail("is a ZIP archive with a broken directory", kHint);
  const std::size_t name = number_at<std::uint16_t>(b, at + 28), extra = number_at<std::uint16_t>(b, at + 30), comment = number_at<std::uint16_t>(b, at + 32);
  if (end - at - kCentralSize < name + extra + comment) source.fail("is a ZIP archive with a broken directory", kHint);
  ZipEntry entry{std::string(b.substr(at + kCentralSize, name)), number_at<std::uint32_t>(b, at + 20), number_at<std::uint32_t>(b, at + 24),
                 number_at<std::uint32_t>(b, at + 42), number_at<std::uint16_t>(b, at + 10), number_at<std::uint16_t>(b, at + 8)};
  read_zip64(b.substr(at + kCentralSize + name, extra), entry);
  at += kCentralSize + name + extra + comment;
  return entry;
}

struct Directory {
  std::size_t at;
  std::uint64_t count;
};

// A locator in front of the end tells where the record with the larger numbers stands.
Directory zip64_directory(const Source& source, std::size_t end) {
  const std::string_view b = source.bytes;
  constexpr std::string_view kLocator{"PK\x06\x07", 4}, kRecord{"PK\x06\x06", 4};
  constexpr std::size_t kLocatorSize = 20, kRecordSize = 56;
  const bool has_locator = end >= kLocatorSize && b.substr(end - kLocatorSize, 4) == kLocator;
  const std::uint64_t at = has_locator ? number_at<std::uint64_t>(b, end - kLocatorSize + 8) : b.size();
  if (at > end || end - at < kRecordSize || b.substr(at, 4) != kRecord) source.fail("is a ZIP64 archive with a broken directory", kHint);
  return {number_at<std::uint64_t>(b, at + 48), number_at<std::uint64_t>(b, at + 32)};
}

std::string_view packed_bytes(const Source& source, const ZipEntry& entry) {
  const std::string_view b = source.bytes;
  if (entry.header > b.size() || b.size() - entry.header < kLocalSize || b.substr(entry.header, 4) != kLocal)
    source.fail(fmt::format("is a ZIP archive whose file {} is not where the directory says", quoted(entry.name)), kHint);
  const std::size_t at = entry.header + kLocalSize + number_at<std::uint16_t>(b, entry.header + 26) + number_at<std::uint16_t>(b, entry.header + 28);
  if (at > b.size() || b.size() - at < entry.packed) source.fail(fmt::format("is a ZIP archive whose file {} is cut off", quoted(entry.name)), kHint);
  return b.substr(at, entry.packed);
}

// Bytes that come out; more than `most` is as good as infinite. Nothing if it is no deflate stream to its end.
std::optional<std::uint64_t> inflated_size(std::string_view packed, std::uint64_t most, const std::function<void(std::string_view)>& see) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
  std::vector<unsigned char> out(kPiece);
  std::uint64_t size = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      const std::size_t n = std::min(packed.size(), kPiece);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
      stream.avail_in = static_cast<uInt>(n);
      packed.remove_prefix(n);
    }
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(kPiece);
    status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) return std::nullopt;
    see({reinterpret_cast<const char*>(out.data()), kPiece - stream.avail_out});
    size += kPiece - stream.avail_out;
    if (size > most) return size;
  }
  return size;
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

bool is_zip(std::string_view bytes) { return bytes.starts_with(kLocal); }

std::vector<ZipEntry> zip_entries(const Source& source) {
  const std::size_t end = find_end(source);
  Directory directory{number_at<std::uint32_t>(source.bytes, end + 16), number_at<std::uint16_t>(source.bytes, end + 10)};
  if (directory.at == kInExtra || directory.count == 0xffff) directory = zip64_directory(source, end);
  std::vector<ZipEntry> entries;
  for (std::uint64_t i = 0; i < directory.count; ++i) entries.push_back(read_entry(source, directory.at, end));
  return entries;
}

void require_harmless(const Source& source, const std::vector<ZipEntry>& entries, std::uint64_t limit, const SeePiece& see) {
  std::uint64_t left = limit;
  for (const ZipEntry& entry : entries) {
    const std::string_view packed = packed_bytes(source, entry);
    const std::string name = quoted(entry.name);
    if (entry.flags & kEncrypted) source.fail(fmt::format("is a ZIP archive whose file {} is encrypted", name), "export the model without a password");
    if (entry.method != kStored && entry.method != kDeflated) source.fail(fmt::format("is a ZIP archive whose file {} is packed by method {}", name, entry.method), "pack it by deflate (method 8)");
    const auto see_piece = [&](std::string_view piece) { see(entry, piece); };
    if (entry.method == kStored) see_piece(packed);
    const auto size = entry.method == kStored ? std::optional<std::uint64_t>(entry.packed) : inflated_size(packed, left, see_piece);
    if (!size) source.fail(fmt::format("is a ZIP archive whose file {} cannot be unpacked", name), kHint);
    if (*size > left) source.fail(fmt::format("is a ZIP archive of {} bytes that unpacks to more than {} bytes: more than any model does", source.bytes.size(), limit), "if it is a model, export it as STL or PLY");
    if (*size != entry.size) source.fail(fmt::format("is a ZIP archive whose file {} unpacks to {} bytes, where the directory says {}", name, *size, entry.size), kHint);
    left -= *size;
  }
}

struct ZipMember::Packer {
  z_stream stream{};
  Packer() {
    constexpr int kMemory = 8;  // zlib's own choice
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  }
  ~Packer() { deflateEnd(&stream); }
};

ZipMember::ZipMember(std::string name) : name_(std::move(name)), packer_(new Packer) {}
ZipMember::~ZipMember() { delete packer_; }

void ZipMember::put(std::string_view text) {
  waiting_ += text;
  if (waiting_.size() >= kPiece) pack(false);
}

void ZipMember::finish() { pack(true); }

void ZipMember::pack(bool last) {
  crc_ = static_cast<std::uint32_t>(crc32(crc_, reinterpret_cast<const Bytef*>(waiting_.data()), static_cast<uInt>(waiting_.size())));
  size_ += waiting_.size();
  z_stream& stream = packer_->stream;
  stream.next_in = reinterpret_cast<Bytef*>(waiting_.data());
  stream.avail_in = static_cast<uInt>(waiting_.size());
  std::array<char, kPiece> out;
  do {
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH);
    packed_.append(out.data(), out.size() - stream.avail_out);
  } while (stream.avail_out == 0);
  waiting_.clear();
}

void write_zip(FdWriter& out, const std::string& label, const std::vector<const ZipMember*>& members) {
  std::string directory;
  std::uint64_t at = 0;
  for (const ZipMember* m : members) {
    require_zip_without_64(label, m->size_, at + m->packed_.size() + kLocalSize + m->name_.size());
    std::string common;  // of the local header and the directory
    for (const std::uint16_t v : {kVersion, kUtf8, kDeflated, std::uint16_t{0}, kDate}) append(common, v);
    append(common, m->crc_);
    append(common, static_cast<std::uint32_t>(m->packed_.size()));
    append(common, static_cast<std::uint32_t>(m->size_));
    append(common, static_cast<std::uint32_t>(m->name_.size()));  // and no extra field
    out.put(kLocal);
    out.put(common);
    out.put(m->name_);
    out.put(m->packed_);
    directory += kCentral;
    append(directory, kVersion);
    directory += common;
    directory.append(10, '\0');  // comment, disk, attributes
    append(directory, static_cast<std::uint32_t>(at));
    directory += m->name_;
    at += kLocalSize + m->name_.size() + m->packed_.size();
  }
  std::string end(kEnd);
  append(end, std::uint32_t{0});
  for (int i = 0; i < 2; ++i) append(end, static_cast<std::uint16_t>(members.size()));
  append(end, static_cast<std::uint32_t>(directory.size()));
  append(end, static_cast<std::uint32_t>(at));
  append(end, std::uint16_t{0});
  out.put(directory);
  out.put(end);
}

}  // namespace burnish
