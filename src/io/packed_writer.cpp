#include "packed_writer.h"

#include "burnish/core/error.h"

namespace burnish {
namespace {

constexpr std::size_t kPortion = std::size_t{1} << 18;

}  // namespace

PackedWriter::PackedWriter(const OutputFile& file, bool compressed) : label_(file.destination()), out_(file.fd(), label_), compressed_(compressed) {
  if (compressed_ && deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ErrorCode::unwritable_output, label_ + ": cannot be compressed", "free some memory, or leave --compressed out");
}

PackedWriter::~PackedWriter() {
  if (compressed_) deflateEnd(&stream_);
}

void PackedWriter::gather(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t n = std::min(bytes.size(), kPortion - waiting_.size());
    waiting_.append(bytes.substr(0, n));
    bytes.remove_prefix(n);
    if (waiting_.size() == kPortion) squeeze(Z_NO_FLUSH);
  }
}

void PackedWriter::squeeze(int flush) {
  stream_.next_in = reinterpret_cast<Bytef*>(waiting_.data());
  stream_.avail_in = static_cast<uInt>(waiting_.size());
  do {
    char* to = out_.reserve(FdWriter::kLargest);
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = FdWriter::kLargest;
    deflate(&stream_, flush);
    out_.commit(FdWriter::kLargest - stream_.avail_out);
  } while (stream_.avail_out == 0);
  waiting_.clear();
}

void PackedWriter::finish() {
  if (compressed_) squeeze(Z_FINISH);
  out_.flush();
}

}  // namespace burnish
