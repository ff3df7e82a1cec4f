// Any bytes at all, read as every format, with and without salvage: they give a soup that keeps its
// promises, or a burnish::Error. Anything else is a bug.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"

namespace {

void require(bool promise) {
  if (!promise) std::abort();
}

void check_promises(const burnish::TriangleSoup& soup) {
  require(!soup.facets.empty());
  for (const burnish::Vec3& p : soup.points) require(burnish::is_finite(p));
  for (const burnish::Facet& facet : soup.facets)
    for (const std::uint32_t corner : facet) require(corner < soup.points.size());
  std::size_t covered = 0;
  for (const burnish::FacetGroup& g : soup.groups) {
    require(g.first_facet == covered && g.facet_count > 0);
    covered += g.facet_count;
  }
  require(soup.groups.empty() || covered == soup.facets.size());
  require(soup.colors.empty() || soup.colors.size() == soup.facets.size());
  for (const burnish::Color c : soup.colors) require(c == burnish::kNoColor || burnish::channel(c, 3) > 0);
}

void read_as(std::span<const std::byte> bytes, const char* label, bool salvage) {
  try {
    check_promises(burnish::read_mesh(bytes, label, {salvage}).soup);
  } catch (const burnish::Error& error) {
    require(error.code() == burnish::ErrorCode::unreadable_input);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  for (const char* label : {"fuzz.stl", "fuzz.obj", "fuzz.ply", "fuzz.off", "fuzz"})
    for (const bool salvage : {false, true}) read_as(bytes, label, salvage);
  return 0;
}
