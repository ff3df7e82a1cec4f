#include "burnish/surface/shells.h"

#include <algorithm>
#include <array>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "ray_winding.h"

namespace burnish {
namespace {

constexpr std::size_t kSamples = 5;  // of a shell, for what lies around it
constexpr std::size_t kGrain = 8192;

Vec3 centroid(const TriangleSoup& soup, std::size_t f) {
  return (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3.0;
}

std::vector<std::uint32_t> number_shells(const TriangleSoup& soup, const EdgeTable& table, std::size_t& count) {
  UnionFind sets(soup.facets.size());
  for (std::size_t e = 0; e < table.size(); ++e)
    for (const EdgeUse& use : table.uses(e)) sets.unite(table.uses(e)[0].facet, use.facet);
  std::vector<std::uint32_t> number(soup.facets.size());
  count = 0;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    number[f] = sets.is_representative(f) ? static_cast<std::uint32_t>(count++) : number[sets.find(f)];
  return number;
}

void mark_closed(const EdgeTable& table, Shells& result) {
  for (Shell& shell : result.shells) shell.closed = shell.area > 0;
  for (std::size_t e = 0; e < table.size(); ++e) {
    int net = 0;
    for (const EdgeUse& use : table.uses(e)) net += use.forward ? 1 : -1;
    if (net != 0) result.shells[result.of_facet[table.uses(e)[0].facet]].closed = false;
  }
}

void measure(const TriangleSoup& soup, Shells& result) {
  std::vector<double> largest(result.shells.size(), -1.0);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    Shell& shell = result.shells[result.of_facet[f]];
    const double facet_area = 0.5 * norm(facet_normal_2a(soup, f));
    ++shell.facets;
    shell.area += facet_area;
    for (int i = 0; i < 3; ++i) shell.box.extend(soup.corner(f, i));
    if (facet_area > largest[result.of_facet[f]]) {
      largest[result.of_facet[f]] = facet_area;
      shell.at = centroid(soup, f);
    }
  }
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    Shell& shell = result.shells[result.of_facet[f]];
    const Vec3 o = shell.box.center();
    shell.volume += dot(soup.corner(f, 0) - o, cross(soup.corner(f, 1) - o, soup.corner(f, 2) - o)) / 6;
  }
}

// A point whose surroundings are asked for, on behalf of a shell.
struct Sample {
  Vec3 at;
  std::uint32_t shell;
};

std::vector<Sample> choose_samples(const TriangleSoup& soup, const Shells& shells) {
  std::vector<Sample> samples;
  std::vector<std::size_t> seen(shells.shells.size(), 0);
  for (std::uint32_t s = 0; s < shells.shells.size(); ++s) samples.push_back({shells.shells[s].at, s});
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const std::uint32_t s = shells.of_facet[f];
    const std::size_t step = std::max<std::size_t>(1, shells.shells[s].facets / (kSamples - 1));
    const std::size_t place = seen[s]++;
    if (place % step == step / 2 && place / step < kSamples - 1) samples.push_back({centroid(soup, f), s});
  }
  return samples;
}

// One crossing of a sample's upward ray with a closed shell.
struct Crossing {
  std::uint32_t sample, shell;
  int sign;
  friend bool operator<(const Crossing& a, const Crossing& b) {
    return std::pair(a.sample, a.shell) < std::pair(b.sample, b.shell);
  }
};

std::vector<Crossing> cross_rays(const TriangleSoup& soup, const Shells& shells, const std::vector<Sample>& samples) {
  std::vector<Vec3> points;
  points.reserve(samples.size());
  for (const Sample& s : samples) points.push_back(s.at);
  const PointColumns columns(points);
  std::vector<std::vector<Crossing>> parts((soup.facets.size() + kGrain - 1) / kGrain);
  parallel_ranges(soup.facets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const std::uint32_t shell = shells.of_facet[f];
      if (!shells.shells[shell].closed) continue;
      const std::array<Vec3, 3> corners{soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2)};
      Box3 box;
      for (const Vec3& c : corners) box.extend(c);
      columns.for_each_in(box, [&](std::uint32_t i) {
        if (samples[i].shell == shell || box.upper.z < samples[i].at.z) return;
        const int sign = passes(corners, samples[i].at);
        if (sign != 0) parts[begin / kGrain].push_back({i, shell, sign});
      });
    }
  });
  std::vector<Crossing> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  return all;
}

// What most of a shell's samples agree on.
void vote(const std::vector<Sample>& samples, const std::vector<Crossing>& crossings, Shells& result) {
  struct Ballot {
    std::uint32_t inner, outer;
    int winding;
    auto operator<=>(const Ballot&) const = default;
  };
  std::vector<std::size_t> voters(result.shells.size(), 0);
  for (const Sample& s : samples) ++voters[s.shell];
  std::vector<Ballot> ballots;
  for (std::size_t i = 0; i < crossings.size();) {
    Ballot ballot{samples[crossings[i].sample].shell, crossings[i].shell, 0};
    std::size_t j = i;
    for (; j < crossings.size() && !(crossings[i] < crossings[j]); ++j) ballot.winding += crossings[j].sign;
    if (ballot.winding != 0) ballots.push_back(ballot);
    i = j;
  }
  std::sort(ballots.begin(), ballots.end());
  for (std::size_t i = 0; i < ballots.size();) {
    std::size_t j = i;
    while (j < ballots.size() && ballots[j] == ballots[i]) ++j;
    Shell& inner = result.shells[ballots[i].inner];
    if (2 * (j - i) > voters[ballots[i].inner]) {
      inner.around.emplace_back(ballots[i].outer, ballots[i].winding);
      inner.wrapped += ballots[i].winding;
    }
    i = j;
  }
}

}  // namespace

Shells find_shells(const TriangleSoup& welded) {
  Shells result;
  const EdgeTable table(welded);
  std::size_t count = 0;
  result.of_facet = number_shells(welded, table, count);
  result.shells.resize(count);
  measure(welded, result);
  mark_closed(table, result);
  if (count < 2) return result;
  const std::vector<Sample> samples = choose_samples(welded, result);
  vote(samples, cross_rays(welded, result, samples), result);
  return result;
}

bool is_misnested(const Shell& s) {
  const bool body = s.volume > 0 && s.wrapped == 0, cavity = s.volume < 0 && s.wrapped == 1;
  return !body && !cavity;
}

std::size_t count_misnested(const Shells& shells) {
  return static_cast<std::size_t>(std::count_if(shells.shells.begin(), shells.shells.end(), is_misnested));
}

UnionFind connected_points(const TriangleSoup& soup) {
  UnionFind sets(soup.points.size());
  for (const Facet& f : soup.facets) {
    sets.unite(f[0], f[1]);
    sets.unite(f[0], f[2]);
  }
  return sets;
}

std::size_t count_connected(const TriangleSoup& soup) {
  UnionFind sets = connected_points(soup);
  std::vector<char> counted(soup.points.size(), 0);
  for (const Facet& f : soup.facets) counted[sets.find(f[0])] = 1;
  return static_cast<std::size_t>(std::count(counted.begin(), counted.end(), 1));
}

}  // namespace burnish
