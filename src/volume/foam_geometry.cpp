#include "foam_geometry.h"

#include <algorithm>

namespace burnish::foam {
namespace {

Vec3 mean_point(Loop loop, Points points) {
  Vec3 sum = points[loop[0]];
  for (std::size_t i = 1; i < loop.size(); ++i) sum += points[loop[i]];
  return sum / static_cast<double>(loop.size());
}

// Calls visit(a, b) for the ends of each of the loop's edges.
template <class Visit>
void for_each_edge(Loop loop, Points points, Visit&& visit) {
  for (std::size_t i = 0; i < loop.size(); ++i) visit(points[loop[i]], points[loop[i + 1 < loop.size() ? i + 1 : 0]]);
}

// Whether all corners turn with the area vector, by more than rounding could hide: what nearly all loops do, and without roots.
bool turns_one_way(Loop loop, Points points, const Vec3& area) {
  constexpr double kClear = 1e-24;
  Vec3 before = points[loop.front()] - points[loop.back()];
  const double square = squared_norm(area);
  bool one_way = true;
  for_each_edge(loop, points, [&](const Vec3& a, const Vec3& b) {
    const Vec3 edge = b - a, turn = cross(before, edge);
    const double with = dot(turn, area);
    one_way = one_way && with > 0 && with * with > kClear * squared_norm(turn) * square;
    before = edge;
  });
  return one_way;
}

// How far the loop reaches from its centre along `direction`, but at least `least`.
double reach(Loop loop, Points points, const Vec3& centre, const Vec3& direction, double least) {
  for (const std::uint32_t p : loop) least = std::max(least, std::fabs(dot(direction, points[p] - centre)));
  return least;
}

// Where the line along d from the owner's centre passes the face, seen from the face's centre; relative to the reach of the face.
double relative_skew(Loop loop, Points points, const Face& face, const Vec3& from_owner, const Vec3& d, double share) {
  const Vec3 skew = from_owner - d * (dot(face.area, from_owner) / (dot(face.area, d) + kRootVerySmall));
  const double length = norm(skew);
  return length / reach(loop, points, face.centre, skew / (length + kRootVerySmall), share * norm(d) + kRootVerySmall);
}

}  // namespace

// [T-QUAL-1]
Face face(Loop loop, Points points) {
  if (loop.size() == 3) {
    const Vec3 &a = points[loop[0]], &b = points[loop[1]], &c = points[loop[2]];
    return {(1.0 / 3.0) * (a + b + c), 0.5 * cross(b - a, c - a)};
  }
  const Vec3 middle = mean_point(loop, points);
  Vec3 normals, weighted;
  double areas = 0;
  for_each_edge(loop, points, [&](const Vec3& a, const Vec3& b) {
    const Vec3 n = cross(b - a, middle - a);
    const double length = norm(n);
    normals += n;
    areas += length;
    weighted += length * (a + b + middle);
  });
  if (areas < kRootVerySmall) return {middle, {}};
  return {(1.0 / 3.0) * weighted / areas, 0.5 * normals};
}

// [T-QUAL-2]
Cell cell(std::span<const Side> sides) {
  Vec3 apex, weighted;
  for (const Side& side : sides) apex += side.centre;
  apex = apex / static_cast<double>(sides.size());
  double threefold = 0;
  for (const Side& side : sides) {
    const double pyramid = dot(side.area, side.centre - apex);
    weighted += pyramid * (0.75 * side.centre + 0.25 * apex);
    threefold += pyramid;
  }
  return {std::fabs(threefold) > kVerySmall ? weighted / threefold : apex, threefold / 3};
}

void gather_sides(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, std::vector<Side>& sides) {
  sides.clear();
  for (const std::uint32_t f : faces[cell]) {
    const Face here = face(mesh.face(f), mesh.points);
    sides.push_back({here.centre, mesh.owner[f] == cell ? here.area : -here.area, f < mesh.internal_faces()});
  }
}

Cell cell(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t c, std::vector<Side>& scratch) {
  gather_sides(mesh, faces, c, scratch);
  return cell(scratch);
}

// [T-QUAL-4]
double skewness(Loop loop, Points points, const Face& face, const Vec3& owner, const Vec3& neighbour) {
  return relative_skew(loop, points, face, face.centre - owner, neighbour - owner, 0.2);
}

double boundary_skewness(Loop loop, Points points, const Face& face, const Vec3& owner) {
  const Vec3 from_owner = face.centre - owner;
  const double length = norm(face.area);
  const Vec3 normal = length < kRootVerySmall ? Vec3{} : face.area / length;
  return relative_skew(loop, points, face, from_owner, normal * dot(normal, from_owner), 0.4);
}

// [T-QUAL-6]
double determinant(std::span<const Side> sides) {
  double areas = 0;
  int internal = 0;
  for (const Side& side : sides)
    if (side.internal) areas += norm(side.area), ++internal;
  if (internal == 0 || areas < kRootVerySmall) return 0;
  const double mean = areas / internal;
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (const Side& side : sides) {
    if (!side.internal) continue;
    const Vec3 s = side.area / mean;
    xx += s.x * s.x, xy += s.x * s.y, xz += s.x * s.z, yy += s.y * s.y, yz += s.y * s.z, zz += s.z * s.z;
  }
  return std::fabs(xx * yy * zz + 2 * xy * yz * xz - xx * yz * yz - yy * xz * xz - zz * xy * xy) / 8;
}

// [T-QUAL-7]
Closedness closedness(std::span<const Side> sides, double volume) {
  Vec3 sum, sizes;
  for (const Side& side : sides) {
    sum += side.area;
    sizes += {std::fabs(side.area.x), std::fabs(side.area.y), std::fabs(side.area.z)};
  }
  double openness = 0;
  for (int axis = 0; axis < 3; ++axis) openness = std::max(openness, std::fabs(sum[axis]) / (sizes[axis] + kRootVerySmall));
  const double root = std::cbrt(std::max(kRootVerySmall, volume));
  const double by_axes = std::max({sizes.x, sizes.y, sizes.z}) / (std::min({sizes.x, sizes.y, sizes.z}) + kRootVerySmall);
  return {openness, std::max(by_axes, (sizes.x + sizes.y + sizes.z) / 6 / (root * root))};
}

// [T-QUAL-8]
bool is_concave(std::span<const Side> sides) {
  constexpr double kPlane = 1e-6;
  for (const Side& plane : sides) {
    const Vec3 normal = plane.area / std::max(norm(plane.area), kVerySmall);
    for (const Side& other : sides) {
      if (&other == &plane) continue;
      const Vec3 d = other.centre - plane.centre;
      const double height = dot(d, normal);
      if (height >= 0 || height * height < kPlane * kPlane * squared_norm(d)) return true;
    }
  }
  return false;
}

// [T-QUAL-9]
double flatness(Loop loop, Points points, const Face& face) {
  const double area = norm(face.area);
  if (loop.size() <= 3 || area <= kRootVerySmall) return 1;
  double areas = 0;
  for_each_edge(loop, points, [&](const Vec3& a, const Vec3& b) { areas += norm(cross(b - a, face.centre - a)); });
  return area / (0.5 * areas + kRootVerySmall);
}

double concave_sine(Loop loop, Points points, const Vec3& area, double least) {
  if (turns_one_way(loop, points, area)) return 0;
  const Vec3 normal = area / (norm(area) + kRootVerySmall);
  Vec3 before = points[loop.front()] - points[loop.back()];
  double length_before = norm(before), greatest = 0;
  before = before / (length_before + kRootVerySmall);
  for_each_edge(loop, points, [&](const Vec3& a, const Vec3& b) {
    Vec3 edge = b - a;
    const double length = norm(edge);
    edge = edge / (length + kRootVerySmall);
    const Vec3 turn = cross(before, edge);
    const double sine = norm(turn);
    if (length_before > kSmall && length > kSmall && sine >= least && dot(turn / sine, normal) < kSmall) greatest = std::max(greatest, sine);
    before = edge;
    length_before = length;
  });
  return greatest;
}

}  // namespace burnish::foam
