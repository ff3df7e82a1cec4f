#include "burnish/surface/registration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kFew = 300, kMany = 10'000;  // samples of a trial, and of the result
constexpr int kTrialRounds = 25, kMostRounds = 200, kSettleRounds = 100;
constexpr std::size_t kFinalists = 4;
constexpr double kNoticeable = 1e-6;  // of the score: what noise leaves to gain
constexpr int kPatience = 10;         // rounds without that much
constexpr double kSmallStep = 1e-13, kConvergedStep = 1e-9;  // of the size
constexpr double kOutlier = 3 * 1.4826;                      // of the median: three standard deviations of a normal distribution
constexpr double kFloor = 1e-12;                             // of the size: no distance below is an outlier
constexpr double kScoreCap = 0.02;                           // of the size: farther is as bad as that
constexpr double kFits = 1e-3, kFitsWell = 5e-3;             // of the size: rms below which no other start is tried
constexpr double kNoFit = 1e-2;                              // of the size: rms from which nothing has converged
constexpr int kHalvings = 12;                                // of a step that does not make the sum of squares less
constexpr double kWithinNoise = 1e-2;                        // of a variance
constexpr double kAll = std::numeric_limits<double>::infinity();
constexpr double kFree = 1e-7;                               // eigenvalue against the largest of a motion that nothing determines

Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Matrix3d rotation_of(const RigidMotion& m) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) r.row(i) = eigen(m.rows[static_cast<std::size_t>(i)]).transpose();
  return r;
}
RigidMotion motion_of(const Eigen::Matrix3d& r, const Vec3& from, const Vec3& to) {
  RigidMotion m;
  for (int i = 0; i < 3; ++i) m.rows[static_cast<std::size_t>(i)] = vec(r.row(i).transpose());
  m.translation = to - m.rotated(from);
  return m;
}

struct Frame {
  Vec3 centre;
  Eigen::Matrix3d axes;  // columns, right-handed
  double area = 0;
};

// Of the surface as a sheet of even density.
Frame principal_frame(const TriangleSoup& soup) {
  Frame frame;
  Vec3 moment;
  const Vec3 origin = bounding_box(soup).center();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double area = norm(facet_normal_2a(soup, f)) / 2;
    const std::array<Vec3, 3> c{soup.corner(f, 0) - origin, soup.corner(f, 1) - origin, soup.corner(f, 2) - origin};
    const Vec3 sum = c[0] + c[1] + c[2];
    frame.area += area;
    moment += sum * (area / 3);
    for (const Vec3& p : {c[0], c[1], c[2], sum}) second += area / 12 * eigen(p) * eigen(p).transpose();
  }
  const Vec3 centre = frame.area > 0 ? moment / frame.area : Vec3{};
  frame.centre = origin + centre;
  second -= frame.area * eigen(centre) * eigen(centre).transpose();
  frame.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors();
  if (frame.axes.determinant() < 0) frame.axes.col(2) *= -1;
  return frame;
}

// Points spread by area: one in each of n equal parts of it.
std::vector<Vec3> samples_of(const TriangleSoup& soup, std::size_t n) {
  std::vector<double> cumulative(soup.facets.size() + 1, 0.0);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) cumulative[f + 1] = cumulative[f] + norm(facet_normal_2a(soup, f));
  std::vector<Vec3> samples(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double target = (static_cast<double>(i) + 0.5) / static_cast<double>(n) * cumulative.back();
    const auto f = static_cast<std::size_t>(std::upper_bound(cumulative.begin(), cumulative.end() - 1, target) - cumulative.begin() - 1);
    double u = std::fmod(0.5 + static_cast<double>(i) * 0.7548776662466927, 1.0), v = std::fmod(0.5 + static_cast<double>(i) * 0.5698402909980532, 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    samples[i] = soup.corner(f, 0) + (soup.corner(f, 1) - soup.corner(f, 0)) * u + (soup.corner(f, 2) - soup.corner(f, 0)) * v;
  }
  return samples;
}

struct Match {
  Vec3 from, to, normal;
  double distance = 0;
};

struct Fit {
  RigidMotion motion;
  double score = kAll;  // mean square distance, each no more than the cap's
  std::size_t rounds = 0;
  int free_motions = 0;
};

struct Step {
  Vec3 centre;
  Vector6 x = Vector6::Zero();  // turn about the centre, and shift in units of the size
  double gain = 0;  // by which it makes the sum of squares less, in units of the size squared
  int free_motions = 0;
};

class Registrar {
 public:
  Registrar(const TriangleSoup& a, const TriangleSoup& b, double size, Progress& progress)
      : b_(b), index_(b), size_(size), few_(samples_of(a, kFew)), many_(samples_of(a, kMany)), frame_a_(principal_frame(a)), frame_b_(principal_frame(b)), progress_(progress) {}

  Registration run() {
    Registration result;
    const auto before = matches(many_, {});
    result.rms_before = rms(before, kAll);
    Fit fit = best(result.starts);
    const auto placed = matches(many_, fit.motion);
    const double limit = outlier_limit(placed);
    std::vector<Vec3> counted;
    for (std::size_t i = 0; i < many_.size(); ++i)
      if (placed[i].distance <= limit) counted.push_back(many_[i]);
    const bool is_minimum = settle(counted, fit);
    result.motion = fit.motion;
    result.rms_after = rms(matches(many_, fit.motion), kAll);
    result.rms_kept = rms(matches(counted, fit.motion), kAll);
    result.kept = static_cast<double>(counted.size()) / static_cast<double>(many_.size());
    result.samples = many_.size();
    result.iterations = fit.rounds;
    result.converged = is_minimum && result.rms_kept < kNoFit * size_;
    result.free_motions = fit.free_motions;
    return result;
  }

 private:
  bool fits(const Fit& fit, double share) const { return fit.score < share * share * size_ * size_; }

  Fit best(std::size_t& starts) const {
    std::vector<Fit> trials;
    const auto add = [&](const std::vector<RigidMotion>& from) {
      const std::size_t first = trials.size();
      trials.resize(first + from.size());
      progress_.check();
      parallel_for(from.size(), [&](std::size_t i) { trials[first + i] = improved(from[i], few_, kTrialRounds); }, 1);
      std::stable_sort(trials.begin(), trials.end(), [&](const Fit& x, const Fit& y) { return x.score < y.score; });
      starts = trials.size();
    };
    add({RigidMotion{}, motion_of(Eigen::Matrix3d::Identity(), frame_a_.centre, frame_b_.centre)});
    if (!fits(trials[0], kFits)) add(axis_starts(false));
    if (!fits(trials[0], kFitsWell)) add(axis_starts(true));
    Fit winner;
    for (std::size_t i = 0; i < std::min(kFinalists, trials.size()); ++i) {
      progress_.check();
      const Fit fit = improved(trials[i].motion, many_, kMostRounds);
      if (fit.score < winner.score * (1 - 1e-6)) winner = fit;
    }
    return winner;
  }

  // The 24 rotations of a cube between the principal axes; `between`: turned further by 45 degrees about each axis.
  std::vector<RigidMotion> axis_starts(bool between) const {
    std::vector<RigidMotion> starts;
    std::array<int, 3> order{0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Eigen::Matrix3d p = Eigen::Matrix3d::Zero();
        for (int i = 0; i < 3; ++i) p(order[static_cast<std::size_t>(i)], i) = signs >> i & 1 ? -1 : 1;
        if (p.determinant() < 0) continue;
        if (!between) starts.push_back(start(p));
        for (int axis = 0; axis < 3 && between; ++axis) starts.push_back(start(Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::Unit(axis)) * p));
      }
    } while (std::next_permutation(order.begin(), order.end()));
    return starts;
  }
  RigidMotion start(const Eigen::Matrix3d& turn) const { return motion_of(frame_b_.axes * turn * frame_a_.axes.transpose(), frame_a_.centre, frame_b_.centre); }

  std::vector<Match> matches(const std::vector<Vec3>& samples, const RigidMotion& motion) const {
    std::vector<Match> found(samples.size());
    parallel_for(samples.size(), [&](std::size_t i) {
      const Vec3 p = motion(samples[i]);
      const TriangleIndex::Closest c = index_.closest(p);
      const Vec3 n = facet_normal_2a(b_, c.facet);
      const double length = norm(n);
      found[i] = {p, c.point, length > 0 ? n / length : Vec3{}, std::sqrt(c.squared_distance)};
    }, 64);
    return found;
  }

  double outlier_limit(const std::vector<Match>& found) const {
    std::vector<double> distances;
    for (const Match& m : found) distances.push_back(m.distance);
    std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2), distances.end());
    return std::max(kOutlier * distances[distances.size() / 2], kFloor * size_);
  }

  static double rms(const std::vector<Match>& found, double limit) {
    double sum = 0;
    std::size_t n = 0;
    for (const Match& m : found)
      if (m.distance <= limit) sum += m.distance * m.distance, ++n;
    return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0;
  }

  double score(const std::vector<Match>& found) const {
    double sum = 0;
    for (const Match& m : found) sum += std::min(m.distance * m.distance, kScoreCap * kScoreCap * size_ * size_);
    return sum / static_cast<double>(found.size());
  }

  Fit improved(const RigidMotion& start, const std::vector<Vec3>& samples, int rounds) const {
    Fit now{start}, least;
    double mark = kAll;  // the score when it last became noticeably less
    int marked = 0;
    for (int i = 0; i < rounds; ++i) {
      const std::vector<Match> found = matches(samples, now.motion);
      now.score = score(found);
      now.rounds = static_cast<std::size_t>(i);
      if (now.score <= least.score) least = now;
      if (now.score < mark * (1 - kNoticeable)) mark = now.score, marked = i;
      const Step by = step(found, outlier_limit(found));
      now.motion = motion(by) * now.motion;
      least.free_motions = by.free_motions;
      if (by.x.norm() < kSmallStep || i - marked >= kPatience) break;
    }
    now.score = score(matches(samples, now.motion));
    now.free_motions = least.free_motions;
    return now.score <= least.score * (1 + 1e-9) ? now : least;
  }

  // With the samples that count fixed, the sum of their squared distances has a minimum, and every step makes it less. Whether it was reached: the
  // next step is less than 1e-9 of the size, or a tenth of the standard deviation that noise of these distances gives the motion.
  bool settle(const std::vector<Vec3>& samples, Fit& fit) const {
    std::vector<Match> found = matches(samples, fit.motion);
    double least = rms(found, kAll);
    for (int i = 0; i < kSettleRounds; ++i) {
      progress_.check();
      towards_closest(found);
      Step by = step(found, kAll);
      ++fit.rounds;
      if (by.x.norm() < kConvergedStep || by.gain * size_ * size_ < kWithinNoise * least * least) return true;
      int halved = 0;
      for (; halved < kHalvings; ++halved, by.x /= 2) {
        const RigidMotion tried = motion(by) * fit.motion;
        found = matches(samples, tried);
        const double now = rms(found, kAll);
        if (now >= least) continue;
        fit.motion = tried, least = now;
        break;
      }
      if (halved == kHalvings) return false;
    }
    return false;
  }

  // Where the closest point is on an edge, the distance grows along the way from it, and not along the normal of one of the facets.
  void towards_closest(std::vector<Match>& found) const {
    for (Match& m : found)
      if (m.distance > kConvergedStep * size_) m.normal = (m.to - m.from) / m.distance;
  }

  // One step of Gauss and Newton on the distances to the tangent planes. [T-ALIGN-1]
  Step step(const std::vector<Match>& found, double limit) const {
    Step by;
    double n = 0;
    for (const Match& m : found)
      if (m.distance <= limit) by.centre += m.from, ++n;
    by.centre = by.centre / std::max(n, 1.0);
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    for (const Match& m : found) {
      if (m.distance > limit) continue;
      Vector6 row;
      row << eigen(cross((m.from - by.centre) / size_, m.normal)), eigen(m.normal);
      normal += row * row.transpose();
      right += row * (dot(m.normal, m.to - m.from) / size_);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(normal);
    const Vector6 values = solver.eigenvalues();
    for (int i = 0; i < 6; ++i) {
      if (!(values[i] > kFree * values[5])) ++by.free_motions;
      else by.x += solver.eigenvectors().col(i) * (solver.eigenvectors().col(i).dot(right) / values[i]);
    }
    by.gain = by.x.dot(right);
    return by;
  }

  RigidMotion motion(const Step& by) const {
    const Eigen::Vector3d turn = by.x.head<3>();
    const double angle = turn.norm();
    const Eigen::Matrix3d r = angle > 0 ? Eigen::AngleAxisd(std::min(angle, 0.5), turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
    return motion_of(r, by.centre, by.centre + vec(by.x.tail<3>()) * size_);
  }

  const TriangleSoup& b_;
  TriangleIndex index_;
  double size_;
  std::vector<Vec3> few_, many_;
  Frame frame_a_, frame_b_;
  Progress& progress_;
};

}  // namespace

RigidMotion RigidMotion::inverse() const {
  RigidMotion m;
  for (int i = 0; i < 3; ++i) m.rows[static_cast<std::size_t>(i)] = {rows[0][i], rows[1][i], rows[2][i]};
  m.translation = -m.rotated(translation);
  return m;
}

// Steps leave R orthogonal but for rounding; a quaternion makes it so again.
RigidMotion operator*(const RigidMotion& outer, const RigidMotion& inner) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation_of(outer) * rotation_of(inner)).normalized();
  return motion_of(q.toRotationMatrix(), {}, outer(inner.translation));
}

double RigidMotion::angle() const { return Eigen::AngleAxisd(rotation_of(*this)).angle(); }
Vec3 RigidMotion::axis() const { return angle() > 0 ? vec(Eigen::AngleAxisd(rotation_of(*this)).axis()) : Vec3{0, 0, 1}; }

Registration register_rigidly(const TriangleSoup& a, const TriangleSoup& b, Progress& progress) {
  const double area_a = area(a), area_b = area(b);
  if (!(area_a > 0) || !(area_b > 0)) {
    Registration none;
    none.free_motions = 6;
    return none;
  }
  const double size = std::max(bounding_box(a).diagonal(), bounding_box(b).diagonal());
  if (area_a <= area_b * (1 + 1e-6)) return Registrar(a, b, size, progress).run();
  Registration turned = Registrar(b, a, size, progress).run();
  turned.motion = turned.motion.inverse();
  return turned;
}

}  // namespace burnish
