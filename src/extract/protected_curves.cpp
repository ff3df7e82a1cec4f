#include "protected_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "burnish/core/union_find.h"
#include "point_grid.h"

namespace burnish::detail {
namespace {

using Polyline = std::vector<Vec3>;

double length_of(const Polyline& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += norm(line[i] - line[i - 1]);
  return sum;
}

bool is_closed(const Polyline& line) { return line.size() > 2 && line.front() == line.back(); }

// Points at equal distances along a polyline, its ends included: jags shorter than a chord are cut.
Polyline resampled(const Polyline& line, double chord) {
  const double length = length_of(line);
  const auto parts = static_cast<std::size_t>(std::max(is_closed(line) ? 3.0 : 1.0, std::ceil(length / chord)));
  Polyline result{line.front()};
  double passed = 0;
  std::size_t i = 1;
  for (std::size_t part = 1; part < parts; ++part) {
    const double wanted = length * static_cast<double>(part) / static_cast<double>(parts);
    while (i + 1 < line.size() && passed + norm(line[i] - line[i - 1]) < wanted) passed += norm(line[i] - line[i - 1]), ++i;
    const double step = norm(line[i] - line[i - 1]);
    result.push_back(step > 0 ? line[i - 1] + (line[i] - line[i - 1]) * std::min(1.0, (wanted - passed) / step) : line[i]);
  }
  result.push_back(line.back());
  return result;
}

// The finite runs of the polylines, without repeated points.
std::vector<Polyline> clean_runs(const std::vector<Polyline>& lines) {
  std::vector<Polyline> runs;
  for (const Polyline& line : lines) {
    runs.emplace_back();
    for (const Vec3& p : line) {
      if (!is_finite(p)) runs.emplace_back();
      else if (runs.back().empty() || runs.back().back() != p) runs.back().push_back(p);
    }
  }
  std::erase_if(runs, [](const Polyline& run) { return run.size() < 2; });
  return runs;
}

// Distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
double segment_distance(const Vec3& p, const Vec3& p2, const Vec3& q, const Vec3& q2) {
  const Vec3 d1 = p2 - p, d2 = q2 - q, r = p - q;
  const double a = squared_norm(d1), e = squared_norm(d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2), denominator = a * e - b * b;
  double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0;
  double t = e > 0 ? (b * s + f) / e : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0;
  }
  return norm(p + d1 * s - (q + d2 * t));
}

// Joins ends that are near to each other, and divides curves at ends near to their middle.
class Joiner {
 public:
  Joiner(std::vector<Polyline> lines, double reach) : lines_(std::move(lines)), reach_(reach) {}

  std::vector<Polyline> run() {
    merge_ends();
    return divided();
  }

 private:
  Vec3& end(std::size_t e) { return e % 2 ? lines_[e / 2].back() : lines_[e / 2].front(); }

  void merge_ends() {
    PointGrid grid(reach_);
    UnionFind sets(2 * lines_.size());
    for (std::uint32_t e = 0; e < 2 * lines_.size(); ++e) {
      grid.for_each_near(end(e), [&](std::uint32_t other) {
        if (norm(end(other) - end(e)) <= reach_) sets.unite(e, other);
      });
      grid.insert(end(e), e);
    }
    std::vector<Vec3> representative;
    for (std::uint32_t e = 0; e < 2 * lines_.size(); ++e) representative.push_back(end(sets.find(e)));
    for (std::uint32_t e = 0; e < 2 * lines_.size(); ++e) end(e) = representative[e];
  }

  std::vector<Polyline> divided() {
    PointGrid grid(reach_);
    std::vector<Vec3> ends;
    for (std::size_t e = 0; e < 2 * lines_.size(); ++e) {
      if (is_closed(lines_[e / 2])) continue;
      grid.insert(end(e), static_cast<std::uint32_t>(ends.size()));
      ends.push_back(end(e));
    }
    std::vector<Polyline> pieces;
    for (const Polyline& line : lines_) divide(line, grid, ends, pieces);
    std::erase_if(pieces, [](const Polyline& p) { return p.size() < 2 || (p.size() == 2 && p[0] == p[1]); });
    return pieces;
  }

  // Interior points near an end take its place; a run of such points is one.
  void divide(const Polyline& line, const PointGrid& grid, const std::vector<Vec3>& ends, std::vector<Polyline>& pieces) const {
    Polyline piece;
    for (const Vec3& p : line) {
      Vec3 at = p;
      double nearest = reach_;
      bool joint = false;
      grid.for_each_near(p, [&](std::uint32_t e) {
        if (norm(ends[e] - p) > nearest) return;
        nearest = norm(ends[e] - p);
        at = ends[e];
        joint = true;
      });
      if (!piece.empty() && piece.back() == at) continue;
      piece.push_back(at);
      if (!joint || piece.size() == 1) continue;
      pieces.push_back(std::move(piece));
      piece = {at};
    }
    pieces.push_back(std::move(piece));
  }

  std::vector<Polyline> lines_;
  double reach_;
};

// Leaves out what comes too near to something else.
class Separator {
 public:
  Separator(const std::vector<Polyline>& lines, double edge) : lines_(lines), edge_(edge) {}

  std::vector<Polyline> run() {
    list_chords();
    PointGrid grid(1.01 * edge_);  // half an edge between chords of half an edge: midpoints within an edge
    for (std::uint32_t c = 0; c < chords_.size(); ++c) {
      if (grid.any_near(middle(c), [&](std::uint32_t other) { return in_conflict(c, other); })) continue;
      grid.insert(middle(c), c);
      chords_[c].kept = true;
    }
    return kept_runs();
  }

 private:
  struct Chord {
    std::uint32_t line, place;
    double from_start, to_end;  // of its middle, along its line
    bool kept = false;
  };

  void list_chords() {
    for (std::uint32_t l = 0; l < lines_.size(); ++l) {
      const double whole = length_of(lines_[l]);
      double passed = 0;
      for (std::uint32_t i = 0; i + 1 < lines_[l].size(); ++i) {
        const double step = norm(lines_[l][i + 1] - lines_[l][i]);
        chords_.push_back({l, i, passed + step / 2, whole - passed - step / 2});
        passed += step;
      }
    }
  }
  const Vec3& start(std::uint32_t c) const { return lines_[chords_[c].line][chords_[c].place]; }
  const Vec3& stop(std::uint32_t c) const { return lines_[chords_[c].line][chords_[c].place + 1]; }
  Vec3 middle(std::uint32_t c) const { return (start(c) + stop(c)) * 0.5; }

  // Whether two chords are near a common end of their curves, and make an angle there that balls can separate.
  bool meet(std::uint32_t a, std::uint32_t b) const {
    const Polyline &p = lines_[chords_[a].line], &q = lines_[chords_[b].line];
    const double reach = 1.5 * edge_;
    const auto near = [&](const Vec3& u, double du, const Vec3& v, double dv) { return u == v && du <= reach && dv <= reach; };
    const Chord &s = chords_[a], &t = chords_[b];
    return near(p.front(), s.from_start, q.front(), t.from_start) || near(p.front(), s.from_start, q.back(), t.to_end) ||
           near(p.back(), s.to_end, q.front(), t.from_start) || near(p.back(), s.to_end, q.back(), t.to_end);
  }
  bool in_conflict(std::uint32_t a, std::uint32_t b) const {
    const Chord &s = chords_[a], &t = chords_[b];
    if (s.line == t.line && std::abs(s.from_start - t.from_start) <= 2 * edge_) {
      return s.place > t.place + 1 && segment_distance(start(a), stop(a), start(b), stop(b)) < 1e-3 * edge_;
    }
    if (meet(a, b)) return is_too_sharp(a, b);
    return segment_distance(start(a), stop(a), start(b), stop(b)) < 0.5 * edge_;
  }
  bool is_too_sharp(std::uint32_t a, std::uint32_t b) const {
    if (start(a) == start(b) || start(a) == stop(b) || stop(a) == start(b) || stop(a) == stop(b)) {
      const bool from_start = start(a) == start(b) || start(a) == stop(b), other_start = start(b) == (from_start ? start(a) : stop(a));
      const Vec3 u = from_start ? stop(a) - start(a) : start(a) - stop(a), v = other_start ? stop(b) - start(b) : start(b) - stop(b);
      return dot(u, v) > 0.94 * norm(u) * norm(v);  // 20 degrees
    }
    return segment_distance(start(a), stop(a), start(b), stop(b)) < 0.1 * edge_;
  }

  std::vector<Polyline> kept_runs() const {
    std::vector<Polyline> runs;
    std::uint32_t line = 0xffffffffu;
    bool open = false;
    for (std::uint32_t c = 0; c < chords_.size(); ++c) {
      if (chords_[c].line != line || !chords_[c].kept) open = false;
      line = chords_[c].line;
      if (!chords_[c].kept) continue;
      if (!open) runs.push_back({start(c)});
      runs.back().push_back(stop(c));
      open = true;
    }
    std::erase_if(runs, [&](const Polyline& run) { return length_of(run) < (is_closed(run) ? 4 : 1) * edge_; });
    return runs;
  }

  const std::vector<Polyline>& lines_;
  double edge_;
  std::vector<Chord> chords_;
};

}  // namespace

std::vector<std::vector<Vec3>> separated_curves(const std::vector<std::vector<Vec3>>& polylines, double edge) {
  std::vector<Polyline> lines;
  for (const Polyline& run : clean_runs(polylines)) lines.push_back(resampled(run, 0.5 * edge));
  const std::vector<Polyline> joined = Joiner(std::move(lines), 0.25 * edge).run();
  return Separator(joined, edge).run();
}

}  // namespace burnish::detail
