// Geometry of faces and cells as OpenFOAM 1912 computes it, for one face or one cell at a time.
//
// What measures a whole mesh and what moves one of its points have to agree to the last bit, so the formulas are here, once. All take points by
// number and look nothing up: a mesher that tries a new place for a point writes it to its array of points and asks again.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish::foam {

// OpenFOAM's constants: what it takes for nothing, and adds to denominators.
inline constexpr double kSmall = 1e-15, kVerySmall = 1e-300, kRootVerySmall = 1e-150, kGreat = 1e15;

using Loop = std::span<const std::uint32_t>;
using Points = std::span<const Vec3>;

// [T-QUAL-1] `area`: by the right-hand rule, with the face's area as its length.
struct Face {
  Vec3 centre, area;
};
Face face(Loop loop, Points points);

// A face seen from one of its cells: `area` points outwards.
struct Side {
  Vec3 centre, area;
  bool internal = false;
};

// [T-QUAL-2]
struct Cell {
  Vec3 centre;
  double volume = 0;
};
Cell cell(std::span<const Side> sides);

// The sides of a cell, from the points as they are now, into `sides` (overwritten).
void gather_sides(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, std::vector<Side>& sides);
Cell cell(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, std::vector<Side>& scratch);

// [T-QUAL-3] Of the angle between the line of both centres and the face's normal; 0 degrees is best, and 90 the end.
inline double cosine(const Vec3& owner, const Vec3& neighbour, const Vec3& area) {
  const Vec3 d = neighbour - owner;
  return dot(d, area) / (norm(d) * norm(area) + kRootVerySmall);
}
inline double degrees(double cosine) { return std::acos(std::fmin(1.0, std::fmax(-1.0, cosine))) * (180 / 3.14159265358979323846); }

// [T-QUAL-4]
double skewness(Loop loop, Points points, const Face& face, const Vec3& owner, const Vec3& neighbour);
double boundary_skewness(Loop loop, Points points, const Face& face, const Vec3& owner);

// [T-QUAL-5] Of the linear interpolation between both centres: 0.5 is best.
inline double weight(const Face& face, const Vec3& owner, const Vec3& neighbour) {
  const double a = std::fabs(dot(face.area, face.centre - owner)), b = std::fabs(dot(face.area, neighbour - face.centre));
  return std::fmin(a, b) / (a + b + kVerySmall);
}
inline double volume_ratio(double a, double b) { return std::fmin(a, b) / (std::fmax(a, b) + kVerySmall); }

// Positive where `apex` is behind the face, as an owner's centre has to be; a neighbour's has to give the opposite.
inline double pyramid_volume(const Face& face, const Vec3& apex) { return dot(face.area, face.centre - apex) / 3; }

// [T-QUAL-6] 1 for a cube inside the mesh, 0 where the areas of internal faces do not span space.
double determinant(std::span<const Side> sides);

// [T-QUAL-7] What is left of the sum of a cell's areas, and how long it is; 1 is best.
struct Closedness {
  double openness, aspect_ratio;
};
Closedness closedness(std::span<const Side> sides, double volume);

// [T-QUAL-8] Whether the centre of any face is not behind the plane of any other.
bool is_concave(std::span<const Side> sides);

// [T-QUAL-9] |area vector| / sum of the areas of its triangles: 1 is flat. Triangles: 1.
double flatness(Loop loop, Points points, const Face& face);
// The greatest sine of an angle by which the loop turns the wrong way, of those above `least`; 0: none.
double concave_sine(Loop loop, Points points, const Vec3& area, double least);

// [T-QUAL-10] How many of three decompositions into tetrahedra fail: from the face's centre to the owner's, to the neighbour's, and from one of the loop's points to both.
// `neighbour`: null for boundary faces.
int tetrahedra_errors(Loop loop, Points points, const Face& face, const Vec3& owner, const Vec3* neighbour);

}  // namespace burnish::foam
