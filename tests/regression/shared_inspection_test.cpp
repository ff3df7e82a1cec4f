// Thickness and alignment of real scans, by what has to hold of any: the way through the solid, triangles that are cut, motions that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/registration.h"
#include "burnish/surface/thickness.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/motions.h"
#include "support/noise.h"
#include "support/shared_data.h"

namespace burnish {
namespace {

using namespace test;

// Those of some names that are there.
std::map<std::string, TriangleSoup> scans(const std::vector<std::string>& names) {
  std::map<std::string, TriangleSoup> found;
  for (const std::string& name : names) {
    const std::filesystem::path file = data_folder() / "common" / (name + ".stl");
    if (std::filesystem::exists(file)) found[name] = weld(read_mesh(file.string()).soup);
  }
  return found;
}

// Each facet cut into four at the middles of its edges: facet 4 f + 3 is the middle one of f.
TriangleSoup cut_in_four(const TriangleSoup& soup) {
  TriangleSoup fine{soup.points, {}, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.points.size()));
    if (is_new) fine.points.push_back((soup.points[a] + soup.points[b]) / 2.0);
    return at->second;
  };
  for (const auto& [a, b, c] : soup.facets) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.facets.insert(fine.facets.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

// A solid is no thicker at a place than the way through it is long.
TEST(SharedInspection, ThicknessIsLessThanTheWayThroughTheSolid) {
  const auto models = scans({"rocker-arm", "homer", "fandisk"});
  if (models.empty()) GTEST_SKIP() << "no evaluation data at " << data_folder();
  for (const auto& [name, soup] : models) {
    const TriangleIndex index(soup);
    const double size = bounding_box(soup).diagonal();
    for (const ThicknessSample& s : thickness_samples(soup, 5000)) {
      const Vec3 n = facet_normal_2a(soup, s.facet), inwards = n / -norm(n);
      const double way = index.first_hit(s.at + inwards * (1e-9 * size), inwards).distance;
      EXPECT_GT(s.thickness, 0) << name;
      EXPECT_LT(s.thickness, way + 1e-8 * size) << name << ", facet " << s.facet;
    }
  }
}

// The same surface in four times as many triangles: the middle one of each four has its centroid, and thickness, where the large one has. Not so where the ball
// is about to reach a facet that is just, or just not, within 60 degrees of facing the place, or behind another: one place in five hundred at most.
TEST(SharedInspection, ThicknessDoesNotDependOnTriangles) {
  const auto models = scans({"rocker-arm", "homer", "fandisk"});
  if (models.empty()) GTEST_SKIP() << "no evaluation data at " << data_folder();
  for (const auto& [name, soup] : models) {
    std::map<std::uint32_t, double> fine;
    for (const ThicknessSample& s : thickness_samples(cut_in_four(soup), 0)) fine[s.facet] = s.thickness;
    const std::vector<ThicknessSample> samples = thickness_samples(soup, 0);
    const auto other = std::count_if(samples.begin(), samples.end(), [&](const ThicknessSample& s) { return std::abs(fine.at(4 * s.facet + 3) / s.thickness - 1) > 0.01; });
    EXPECT_LE(static_cast<double>(other), 0.002 * static_cast<double>(samples.size())) << name;
  }
}

struct Offness {
  double degrees = 0, shift = 0;  // of the rotation; of where the middle of the box goes, in diagonals
};

Offness difference(const RigidMotion& found, const RigidMotion& truth, const Box3& box) {
  return {(truth.inverse() * found).angle() * 180 / std::numbers::pi, norm(found((box.lower + box.upper) / 2.0) - truth((box.lower + box.upper) / 2.0)) / box.diagonal()};
}

RigidMotion random_motion(unsigned seed, double size) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Vec3 axis{unit(random), unit(random), unit(random)};
  return turn(axis, std::numbers::pi * unit(random), Vec3{unit(random), unit(random), unit(random)} * (2 * size));
}

const std::vector<std::string> kAligned{"rocker-arm", "spot", "stanford-bunny"};

// Where the scans are, the motion of a copy is found to within `most`; `copied` makes it of a scan, before it is moved.
template <class Copied>
void expect_found(Copied&& copied, const Offness& most) {
  const auto models = scans(kAligned);
  if (models.empty()) GTEST_SKIP() << "no evaluation data at " << data_folder();
  for (const auto& [name, soup] : models)
    for (const unsigned seed : {1u, 2u}) {
      const RigidMotion truth = random_motion(seed, bounding_box(soup).diagonal());
      const Registration r = register_rigidly(soup, by(truth, copied(soup, seed)));
      const Offness off = difference(r.motion, truth, bounding_box(soup));
      EXPECT_TRUE(r.converged) << name << seed;
      EXPECT_LT(off.degrees, most.degrees) << name << seed;
      EXPECT_LT(off.shift, most.shift) << name << seed;
    }
}

TEST(SharedInspection, AlignmentFindsTheMotionOfACopy) {
  expect_found([](const TriangleSoup& soup, unsigned) { return soup; }, {.degrees = 1e-7, .shift = 1e-9});
}

// As a second scan has it: noise of 0.2 mean edges at each point.
TEST(SharedInspection, AlignmentFindsTheMotionOfANoisyCopy) {
  expect_found([](const TriangleSoup& soup, unsigned seed) { return with_noise(soup, 0.2, seed); }, {.degrees = 0.15, .shift = 1e-3});
}

}  // namespace
}  // namespace burnish
