#include "vtk_appended.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "system_hint.h"

namespace burnish {
namespace {

constexpr int kOffsetDigits = 20;  // of the largest 64-bit number
constexpr int kLevel = 1;          // of zlib: higher ones take several times as long for a tenth of the size

std::vector<Bytef> compressed(const char* bytes, std::size_t size) {
  uLongf length = compressBound(static_cast<uLong>(size));
  std::vector<Bytef> result(length);
  // Fails for lack of memory only, which the vector would have found.
  if (compress2(result.data(), &length, reinterpret_cast<const Bytef*>(bytes), static_cast<uLong>(size), kLevel) != Z_OK)
    throw Error(ErrorCode::memory_limit, "zlib: not enough memory to compress a block", "free some memory, or choose larger cells (--cell)");
  result.resize(length);
  return result;
}

}  // namespace

void VtkAppended::text(std::string_view text) {
  out_.put(text);
  position_ += text.size();
}

void VtkAppended::announce(std::string_view type, std::string_view name, std::size_t tuples, int components) {
  text(fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" NumberOfTuples=\"{}\" format=\"appended\" offset=\"", type,
                   name, components, tuples));
  offsets_.push_back(position_);
  text(fmt::format("{:<{}}/>\n", "", kOffsetDigits + 1));
}

void VtkAppended::begin_data() {
  text("  <AppendedData encoding=\"raw\">\n   _");
  data_ = position_;
}

void VtkAppended::begin_array(std::size_t bytes) {
  assert(next_ < offsets_.size());
  put_at(offsets_[next_], fmt::format("{}\"", position_ - data_).c_str(), fmt::formatted_size("{}\"", position_ - data_));
  ++next_;
  array_ = position_;
  table_.assign(3 + (bytes + kBlock - 1) / kBlock, 0);
  table_[0] = table_.size() - 3;
  table_[1] = kBlock;
  table_[2] = bytes % kBlock;
  compressed_ = 0;
  text({reinterpret_cast<const char*>(table_.data()), table_.size() * sizeof(std::uint64_t)});
}

void VtkAppended::put(const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const std::size_t n = std::min(size, kBatch * kBlock - waiting_.size());
    waiting_.insert(waiting_.end(), from, from + n);
    from += n;
    size -= n;
    if (waiting_.size() == kBatch * kBlock) compress_batch();
  }
}

void VtkAppended::compress_batch() {
  std::vector<std::vector<Bytef>> blocks((waiting_.size() + kBlock - 1) / kBlock);
  parallel_chunks(blocks.size(), [&](std::size_t b) {
    blocks[b] = compressed(waiting_.data() + b * kBlock, std::min(kBlock, waiting_.size() - b * kBlock));
  });
  for (const auto& block : blocks) {
    text({reinterpret_cast<const char*>(block.data()), block.size()});
    table_[3 + compressed_++] = block.size();
  }
  waiting_.clear();
}

void VtkAppended::end_array() {
  if (!waiting_.empty()) compress_batch();
  assert(compressed_ == table_[0]);
  put_at(array_, table_.data(), table_.size() * sizeof(std::uint64_t));
}

void VtkAppended::finish() {
  assert(next_ == offsets_.size());
  text("\n  </AppendedData>\n</VTKFile>\n");
  out_.flush();
}

void VtkAppended::put_at(std::uint64_t position, const void* bytes, std::size_t size) {
  out_.flush();
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t n = ::pwrite(fd_, from, size, static_cast<off_t>(position));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(ErrorCode::unwritable_output, label_ + ": cannot be written: " + std::strerror(errno), write_hint(errno));
    from += n;
    size -= static_cast<std::size_t>(n);
    position += static_cast<std::uint64_t>(n);
  }
}

}  // namespace burnish
