// The nozzle as drawn: a turned body and a bore whose axis leaves the body's towards the orifice.
// Millimetres; the fuel leaves at z = 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "example_parts.h"

namespace burnish::example {
namespace {

// A corner of a profile, as a lathe would follow it.
struct Corner {
  double r, z;
};

constexpr double kLength = 6;

constexpr std::array<Corner, 19> kBody{{
    {0.00, 0.00}, {0.36, 0.00}, {0.50, 0.03}, {0.64, 0.10}, {0.76, 0.21}, {0.86, 0.36}, {0.94, 0.56},
    {0.98, 0.80}, {1.00, 1.05}, {1.00, 2.20}, {1.05, 2.30}, {1.55, 2.95}, {1.65, 3.05}, {1.65, 4.70},
    {1.45, 4.80}, {1.45, 5.05}, {1.65, 5.15}, {1.65, 5.90}, {1.55, 6.00},
}};

// The orifice, tapered towards the exit; its rounded inlet; the sac; the seat; the needle guide.
constexpr std::array<Corner, 14> kBore{{
    {0.095, 0.00}, {0.120, 0.52}, {0.130, 0.58}, {0.150, 0.61}, {0.200, 0.64}, {0.270, 0.69}, {0.320, 0.76},
    {0.345, 0.85}, {0.350, 0.95}, {0.350, 1.10}, {0.400, 1.20}, {0.780, 1.85}, {0.830, 1.95}, {0.830, 6.00},
}};

// The bore's axis runs off the body's by 0.05 at the exit.
Vec3 bore_axis(double z) {
  const double d = std::max(0.0, 1 - z / 2);
  return {0.04 * d * d, 0.03 * d * d, z};
}

double squared_distance(const Corner& p, const Corner& a, const Corner& b) {
  const double er = b.r - a.r, ez = b.z - a.z;
  const double along = ((p.r - a.r) * er + (p.z - a.z) * ez) / (er * er + ez * ez);
  const double s = std::clamp(along, 0.0, 1.0);
  const double dr = p.r - a.r - s * er, dz = p.z - a.z - s * ez;
  return dr * dr + dz * dz;
}

// The distance to a profile, negative between it and the axis. A profile is a chain of segments that a
// line of constant z crosses at most once.
class Profile {
 public:
  void add(const Corner& from, const Corner& to) { segments_.push_back({from, to}); }

  double distance(const Corner& p) const {
    double squared = std::numeric_limits<double>::infinity();
    bool inside = false;
    for (const Segment& s : segments_) {
      squared = std::min(squared, squared_distance(p, s.from, s.to));
      if ((s.from.z <= p.z) != (s.to.z <= p.z))
        inside = p.r < s.from.r + (p.z - s.from.z) / (s.to.z - s.from.z) * (s.to.r - s.from.r);
    }
    return inside ? -std::sqrt(squared) : std::sqrt(squared);
  }

 private:
  struct Segment {
    Corner from, to;
  };
  std::vector<Segment> segments_;
};

Profile body_profile() {
  Profile profile;
  for (std::size_t i = 1; i < kBody.size(); ++i) profile.add(kBody[i - 1], kBody[i]);
  profile.add(kBody.back(), {0, kLength});
  return profile;
}

// Goes on beyond both ends, so that subtracting it from the body leaves no lid.
Profile bore_profile() {
  constexpr double kBeyond = 2;
  Profile profile;
  profile.add({kBore.front().r, -kBeyond}, kBore.front());
  for (std::size_t i = 1; i < kBore.size(); ++i) profile.add(kBore[i - 1], kBore[i]);
  profile.add(kBore.back(), {kBore.back().r, kLength + kBeyond});
  return profile;
}

// A corner on the way around the wall's section; `bore` is 0 on the body's axis and 1 on the bore's.
struct WallCorner {
  Corner at;
  double bore;
};

// Up the body and down the bore.
std::vector<WallCorner> wall_section() {
  std::vector<WallCorner> section;
  for (std::size_t i = 1; i < kBody.size(); ++i) section.push_back({kBody[i], 0});
  for (std::size_t i = kBore.size(); i-- > 0;) section.push_back({kBore[i], 1});
  return section;
}

// Adds the rings from `a` on, up to and without `b`, at most 0.05 apart.
void add_rings(TriangleSoup& soup, const WallCorner& a, const WallCorner& b, std::vector<Ring>& rings) {
  constexpr int kAround = 192;
  constexpr double kSpacing = 0.05;
  const int steps =
      std::max(1, static_cast<int>(std::ceil(std::hypot(b.at.r - a.at.r, b.at.z - a.at.z) / kSpacing)));
  for (int i = 0; i < steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    const double z = a.at.z + s * (b.at.z - a.at.z);
    const double share = a.bore + s * (b.bore - a.bore);
    Vec3 center = share * bore_axis(z);
    center.z = z;
    rings.push_back(add_ring(soup, center, a.at.r + s * (b.at.r - a.at.r), even_angles(kAround)));
  }
}

}  // namespace

TriangleSoup make_nozzle() {
  TriangleSoup soup;
  std::vector<Ring> rings;
  const std::vector<WallCorner> section = wall_section();
  for (std::size_t i = 0; i < section.size(); ++i)
    add_rings(soup, section[i], section[(i + 1) % section.size()], rings);
  for (std::size_t i = 0; i < rings.size(); ++i) join(soup, rings[i], rings[(i + 1) % rings.size()]);
  return soup;
}

double nozzle_distance(const Vec3& p) {
  static const Profile body = body_profile();
  static const Profile bore = bore_profile();
  const Vec3 axis = bore_axis(p.z);
  return std::max(body.distance({std::hypot(p.x, p.y), p.z}),
                  -bore.distance({std::hypot(p.x - axis.x, p.y - axis.y), p.z}));
}

}  // namespace burnish::example
