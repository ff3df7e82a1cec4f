// Uses Burnish as an installed library: the README's example of the API, on a box with a missing facet.
#include <burnish/core/build_info.h>
#include <burnish/core/error.h>
#include <burnish/io/mesh_io.h>
#include <burnish/surface/inspect.h>
#include <burnish/surface/weld.h>

#include <cstdio>
#include <span>
#include <string_view>

namespace {

constexpr std::string_view kOpenTetrahedron = R"(solid open
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet
endsolid open
)";

}  // namespace

int main() {
  try {
    const auto bytes = std::as_bytes(std::span(kOpenTetrahedron));
    const burnish::MeshFile file = burnish::read_mesh(bytes, "open.stl");
    const burnish::Defects defects = burnish::inspect(burnish::weld(file.soup)).defects;
    std::printf("%zu facets, %zu points, %zu open edges in %zu loops\n", defects.facets, defects.points,
                defects.open_edges, defects.open_loops);
    std::printf("burnish %.*s\n", static_cast<int>(burnish::build_info().version.size()), burnish::build_info().version.data());
    const bool as_expected = !burnish::build_info().dependencies.empty() && defects.facets == 3 && defects.points == 4 && defects.open_edges == 3 &&
                             defects.open_loops == 1 && !defects.valid_solid();
    return as_expected ? 0 : 1;
  } catch (const burnish::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
