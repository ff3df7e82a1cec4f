// ZIP archives: what is in one, and writing one. (PKWARE's APPNOTE 6.3.)
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "fd_writer.h"
#include "source.h"

namespace burnish {

// Whether the bytes begin as an archive with a file in it.
bool is_zip(std::string_view bytes);

struct ZipEntry {
  std::string name;
  std::uint64_t packed = 0, size = 0;  // bytes
  std::uint64_t header = 0;            // where its local header begins
  std::uint16_t method = 0, flags = 0;
};

// The files in an archive, by its central directory. Throws through `source` for an archive that is cut off or contradicts itself.
std::vector<ZipEntry> zip_entries(const Source& source);

// Inflates every file, keeping nothing, and throws through `source` if one is not what the directory says (its size, its CRC is left to others),
// is encrypted, packed by another method than deflate, or all together have more than `limit` bytes. Bounded memory. `see` gets the files' bytes in pieces.
using SeePiece = std::function<void(const ZipEntry&, std::string_view)>;
void require_harmless(const Source& source, const std::vector<ZipEntry>& entries, std::uint64_t limit, const SeePiece& see);

// A file of an archive that is being made: text is packed as it comes. No time stamps: the same text gives the same bytes.
class ZipMember {
 public:
  explicit ZipMember(std::string name);
  ~ZipMember();
  ZipMember(const ZipMember&) = delete;
  ZipMember& operator=(const ZipMember&) = delete;

  void put(std::string_view text);
  void finish();

 private:
  friend void write_zip(FdWriter& out, const std::string& label, const std::vector<const ZipMember*>& members);
  struct Packer;
  void pack(bool last);

  std::string name_, waiting_, packed_;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;
  Packer* packer_;
};

// Throws Error{unwritable_output} for archives of 4 GiB and more, or with such files.
void write_zip(FdWriter& out, const std::string& label, const std::vector<const ZipMember*>& members);

}  // namespace burnish
