// ZIP archives in memory, true or false, and the 3MF in one.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "support/mesh_bytes.h"

namespace burnish::test {

struct ZipFile {
  std::string name, text;
  std::int64_t more_bytes = 0;   // that the archive says there are
  std::uint32_t crc_change = 0;  // that the archive says, by exclusive or
};

inline std::string deflated(const std::string& text) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string zip_of(const std::vector<ZipFile>& files) {
  std::string archive, directory;
  for (const ZipFile& f : files) {
    const std::string packed = deflated(f.text);
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(f.text.data()), static_cast<uInt>(f.text.size())) ^ f.crc_change;
    std::string common;
    for (const int v : {20, 0, 8, 0, 0x21}) append_raw(common, static_cast<std::uint16_t>(v));
    append_raw(common, static_cast<std::uint32_t>(crc));
    append_raw(common, static_cast<std::uint32_t>(packed.size()));
    append_raw(common, static_cast<std::uint32_t>(static_cast<std::int64_t>(f.text.size()) + f.more_bytes));
    append_raw(common, static_cast<std::uint32_t>(f.name.size()));
    directory += "PK\x01\x02";
    append_raw(directory, std::uint16_t{20});
    directory += common + std::string(10, '\0');
    append_raw(directory, static_cast<std::uint32_t>(archive.size()));
    directory += f.name;
    archive += "PK\x03\x04" + common + f.name + packed;
  }
  std::string end("PK\x05\x06\0\0\0\0", 8);
  for (int i = 0; i < 2; ++i) append_raw(end, static_cast<std::uint16_t>(files.size()));
  append_raw(end, static_cast<std::uint32_t>(directory.size()));
  append_raw(end, static_cast<std::uint32_t>(archive.size()));
  append_raw(end, std::uint16_t{0});
  return archive + directory + end;
}

// The three files of a 3MF with this model.
inline std::vector<ZipFile> parts_of_3mf(const std::string& model) {
  return {{"[Content_Types].xml", R"(<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">)"
                                  R"(<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>)"
                                  R"(<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
          {"_rels/.rels", R"(<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
                          R"(<Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)"},
          {"3D/3dmodel.model", model}};
}

}  // namespace burnish::test
