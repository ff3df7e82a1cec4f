// What a user can ask of a cleaning run, and what it was resolved to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "burnish/core/length.h"
#include "burnish/levelset/redistance.h"

namespace burnish {

// The two gears of repair. *Local* mends the facets that are broken and leaves all others as they are, bit for bit;
// *level set* rebuilds the whole surface from the solid it bounds.
enum class Method {
  automatic,  // local where its result verifies and nothing is lost; else, or to smooth, the level set
  local,      // local, or an error
  level_set,
};

// What a body inside a body is.
enum class Nesting {
  automatic,  // a cavity if it is oriented against what surrounds it; else part of the solid
  solid,      // always part of the solid: cavities are filled
  cavity,     // every second layer is a cavity, however it is oriented
};

// How a surface is smoothed.
enum class SmoothMode {
  automatic,  // `feature` for random noise and for creases, `volume` for what is rough otherwise [T-AUTO-2]
  feature,    // normals filtered on the facets, points moved to them: sharp edges stay (surface/denoise.h)
  volume,     // diffusion of the level set that shrinks nothing to first order
  mcf,        // mean-curvature flow, the thesis' method
  filtered,   // curvature against its own average: spheres are kept exactly
  reinit,     // the thesis' excessive reinitialisation
};

// What extracts the surface of a level set.
enum class Extractor {
  automatic,   // Delaunay up to a predicted number of facets, the octree's beyond [T-SURFACE-1]
  delaunay,    // CGAL's surface mesher: well-shaped facets of a chosen size (extract/delaunay.h)
  tetrahedra,  // marching tetrahedra on the octree: fast, facets of about half a cell (extract/marching_tetrahedra.h)
};

std::string_view name(Method method);    // "auto", "local", "levelset"
std::string_view name(Nesting nesting);  // "auto", "solid", "cavity"
std::string_view name(Extractor surface);  // "auto", "delaunay", "tetrahedra"
std::string_view name(SmoothMode mode);  // "auto", "feature", "volume", "mcf", "filtered", "reinit"

// A volume in the model's units, or a share of the largest component's.
struct VolumeLimit {
  double value = 0;
  bool percent_of_largest = false;
};

// Sharper edges of the surface are creases, in degrees, unless another angle is asked for.
inline constexpr double kCreaseAngle = 40;

// Of an input that is a volume of numbers on a uniform grid (io/voxel_volume.h): its surface is where they have a value.
struct VolumeOptions {
  bool asked = false;         // the input has to be a volume; those named .vti, .nrrd or .nhdr are anyway
  std::optional<double> iso;  // the value; has to be given, or
  bool iso_auto = false;      // Otsu's threshold is taken (levelset/from_voxels.h)
  bool below = false;         // inside are the values below it
  std::string array;          // which of several; empty: the active one, or the first

  bool any() const { return asked || iso || iso_auto || below || !array.empty(); }
};

// Options that a run takes as they are asked, and reports so.
struct PlainOptions {
  // The noise is estimated and removed, and nothing else; a surface without noise is not smoothed.
  bool smooth_auto = false;
  // As resolved, never automatic once smoothing has begun.
  SmoothMode mode = SmoothMode::automatic;
  // The enclosed volume stays what it was.
  bool keep_volume = true;
  // Edges at which facets meet at more than this angle stay sharp, in degrees. Unset: chosen from the noise for denoising, kCreaseAngle for extraction.
  std::optional<double> crease_angle;
  // What keeps the flow of `smooth` a distance function.
  RedistanceMethod redistance = RedistanceMethod::closest;
  // What extracts the surface; naming one, or an edge, an edge tolerance or an angle, asks for the level set.
  Extractor surface = Extractor::automatic;
  // Of facets, in degrees, away from creases. Asks for Delaunay.
  std::optional<double> min_angle;
  // The result, of whichever gear, is simplified to this many facets, or as far as it stays within `simplify` of what it was.
  std::optional<std::size_t> facets;
  // The run plans to stay below this many bytes: a default cell is coarsened for it, an explicit one
  // that needs more ends the run with Error{memory_limit}.
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
};

// Options that are lengths. As asked they are a Length, which may be relative; as resolved a double, in model units.
template <class L>
struct LengthOptions {
  // Blocks of cells are coarser where interpolation between their nodes is off by no more than this. Unset: all cells are finest. Asks for the level set.
  std::optional<L> adapt;
  // Only what is curved more than a sphere of this radius is smoothed.
  std::optional<L> curvature_radius;
  // Bound on the distance between the smoothed and the repaired surface. Unset: no bound.
  std::optional<L> deviation;
  // Points of open edges closer than this are joined: closes cracks up to that width.
  std::optional<L> gap;
  // Openings wider than this stay open: the diameter of a circle of the same perimeter. Unset: all are closed.
  std::optional<L> max_hole;
  // The result is a shell of this thickness about all facets.
  std::optional<L> thicken;
  // The surface is moved outwards by this much; as resolved, inwards if negative. Asks for the level set.
  std::optional<L> offset;
  // Only a wall of this thickness stays of the solid, inside its surface; asks for the level set.
  std::optional<L> hollow;
  // Length of the facets' edges. Unset: about a cell for Delaunay, half a cell for tetrahedra.
  std::optional<L> edge;
  // Facets are larger where the surface is flat: as large as stays within this of it. Asks for Delaunay.
  std::optional<L> edge_tolerance;
  // The result, of whichever gear, is simplified as far as it stays within this of what it was.
  std::optional<L> simplify;

  // Whether a surface parallel to the model's is asked for.
  bool moves_walls() const { return offset || hollow; }
};

// As asked. Lengths become model units once (pipeline/resolve_options.h).
struct CleanOptions : PlainOptions, LengthOptions<Length> {
  // What the model's coordinates are in. Nothing depends on it but what reports say; it goes before what a file says of itself.
  std::optional<ModelUnit> unit;
  VolumeOptions volume;
  Method method = Method::automatic;
  Nesting nesting = Nesting::automatic;
  // Side of the finest cells. At most one of `cell` and `resolution` is set; with neither, the cell
  // follows from the model (docs/choosing-parameters.md). Either of them asks for the level set.
  std::optional<Length> cell;
  // Cells along the longest side of the bounding box.
  std::optional<int> resolution;
  // The cell where neither is set and a level set is needed, instead of one that follows from the model: smaller if smoothing asks for it, larger if the memory
  // budget does. Asks for nothing.
  std::optional<Length> default_cell;
  // With `adapt`, bounds the cells of coarser blocks (8 times the finest when unset).
  std::optional<Length> cell_max;
  // Wavelengths below this length are removed (attenuated tenfold or more). 0: no smoothing, unless `smooth_auto`.
  Length smooth{};
  // A file with boxes and spheres, or with a closed surface, to which smoothing is limited (io/region_file.h). Empty: everywhere.
  std::string region;
  // No opening is closed: max_hole of zero.
  bool keep_openings = false;
  // `offset` is inwards.
  bool offset_inwards = false;
  // Only the component with the largest volume stays.
  bool keep_largest = false;
  // Components with less volume than this are dropped.
  std::optional<VolumeLimit> min_component;
  // Moves the model so that its bounding box is centred near the origin.
  bool recentre = false;
  // Several runs at once share `memory_bytes`. Where a share does not suffice, the run ends with Error{memory_limit}, a default cell or not, so that it can
  // be repeated alone: no result depends on the number of shares.
  std::uint32_t memory_shares = 1;

  std::uint64_t share_of_memory() const { return memory_bytes / memory_shares; }

  bool keeps_openings() const { return keep_openings || max_hole; }
  bool smooths() const { return smooth_auto || smooth.value > 0; }
  // Whether something is asked of the surface that an extraction has to do.
  bool asks_for_extraction() const { return surface != Extractor::automatic || edge || asks_for_delaunay(); }
  bool asks_for_delaunay() const { return edge_tolerance || min_angle; }
  bool simplifies() const { return facets || simplify; }
  // Whether smoothing is measured in cells, which facets have none of.
  bool smooths_in_cells() const { return smooth.unit == LengthUnit::cells || (deviation && deviation->unit == LengthUnit::cells); }
};

// As resolved, in model units.
struct ResolvedOptions : PlainOptions, LengthOptions<double> {
  double cell = 0;               // 0: no level set was built
  bool cell_was_chosen = false;  // by default rule, not by the user
  double cells_along_longest_side = 0;
  int coarsest_level = 0;        // cells at the surface are at most 2^coarsest_level finest cells wide
  double smooth = 0;             // 0: no smoothing, or at the noise's own scale
};

}  // namespace burnish
