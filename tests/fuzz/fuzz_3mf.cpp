// Any bytes at all, as an archive and as the model in a good one (whose checksums no fuzzer would guess): a soup that keeps its promises, or a
// burnish::Error. Anything else is a bug.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "support/zip_bytes.h"

namespace {

void require(bool promise) {
  if (!promise) std::abort();
}

void read(const std::string& bytes) {
  try {
    const burnish::TriangleSoup soup = burnish::read_mesh(std::as_bytes(std::span(bytes)), "fuzz.3mf", {}).soup;
    require(!soup.facets.empty());
    for (const burnish::Vec3& p : soup.points) require(burnish::is_finite(p));
    for (const burnish::Facet& facet : soup.facets)
      for (const std::uint32_t corner : facet) require(corner < soup.points.size());
    require(soup.colors.empty() || soup.colors.size() == soup.facets.size());
  } catch (const burnish::Error& error) {
    require(error.code() == burnish::ErrorCode::unreadable_input);
  }
}

}  // namespace

// lib3mf 1.8 forgets what libzip has opened when an archive turns out to be broken. Everything else that leaks is told.
extern "C" const char* __lsan_default_suppressions() { return "leak:libzip.so\n"; }  // NOLINT(bugprone-reserved-identifier): the sanitizer's name


extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read(bytes);
  read(burnish::test::zip_of(burnish::test::parts_of_3mf(bytes)));
  return 0;
}
