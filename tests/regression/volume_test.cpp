// From a volume of numbers to a clean STL: how far from the truth, without and with smoothing.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "burnish/core/error.h"
#include "burnish/io/voxel_volume.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/sweep.h"
#include "burnish/surface/inspect.h"
#include "support/folder.h"

namespace burnish {
namespace {

using namespace test;

const Vec3 kCenter{0.31, -0.17, 0.23};
constexpr double kRadius = 20;
constexpr std::uint32_t kSide = 50;
constexpr double kLow = -0.5 * (kSide - 1);

// Of a voxel's 8^3 points, those that are in the ball.
double share_of_ball(const Vec3& at) {
  const double d = norm(at - kCenter) - kRadius;
  if (std::abs(d) > 0.9) return d < 0;
  int in = 0;
  for (int c = 0; c < 512; ++c) in += norm(at + Vec3{(c % 8 + 0.5) / 8 - 0.5, (c / 8 % 8 + 0.5) / 8 - 0.5, (c / 64 + 0.5) / 8 - 0.5} - kCenter) < kRadius;
  return in / 512.0;
}

enum class Voxels { shares, steps };

class FromVolume : public ::testing::Test {
 protected:
  std::string volume(Voxels voxels) {
    VoxelSource source{{kSide, kSide, kSide}, {kLow, kLow, kLow}, {1, 1, 1}, "ball", {}};
    source.fill = [&](std::uint32_t first, std::uint32_t last, std::span<float> values) {
      std::size_t n = 0;
      for (std::uint32_t k = first; k < last; ++k)
        for (std::uint32_t j = 0; j < kSide; ++j)
          for (std::uint32_t i = 0; i < kSide; ++i) {
            const double share = share_of_ball({kLow + i, kLow + j, kLow + k});
            values[n++] = static_cast<float>(voxels == Voxels::shares ? std::round(255 * share) : share > 0.5);
          }
    };
    const std::string path = folder_.path("ball.vti");
    const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0644);
    write_voxels(fd, path, source, VoxelFormat::vti);
    ::close(fd);
    return path;
  }

  CleanJob job(Voxels voxels, double smooth) {
    CleanJob job;
    job.input = volume(voxels);
    job.output = folder_.path("x.stl");
    job.overwrite = true;
    job.options.volume.iso = voxels == Voxels::shares ? 127.5 : 0.5;
    if (smooth > 0) {
      job.options.smooth = {smooth, LengthUnit::cells};
      job.options.mode = SmoothMode::volume;
    }
    return job;
  }

  // Of the points of the written file, root of the mean square.
  double rms() {
    const TriangleSoup soup = folder_.read("x.stl");
    double sum = 0;
    for (const Vec3& p : soup.points) sum += std::pow(norm(p - kCenter) - kRadius, 2);
    return std::sqrt(sum / static_cast<double>(soup.points.size()));
  }

  Folder folder_;
};

struct Bound {
  Voxels voxels;
  double smooth;  // cells
  double volume;  // relative
  double rms;     // cells
};

TEST_F(FromVolume, ABallComesBackWithinStatedBounds) {
  const double exact = 4.0 / 3 * std::numbers::pi * std::pow(kRadius, 3);
  for (const Bound& bound : {Bound{Voxels::shares, 0, 3e-3, 0.045}, Bound{Voxels::shares, 4, 4e-3, 0.022}, Bound{Voxels::steps, 0, 3e-3, 0.2}, Bound{Voxels::steps, 4, 4e-3, 0.075}}) {
    const RepairReport report = clean(job(bound.voxels, bound.smooth));
    ASSERT_TRUE(report.written && report.verified && !report.failure);
    const double volume = report.after.volume / exact - 1;
    std::printf("smooth %.0f: volume %+.2e, rms %.4f\n", bound.smooth, volume, rms());
    EXPECT_NEAR(volume, 0, bound.volume);
    EXPECT_LT(rms(), bound.rms);
    EXPECT_EQ(report.surface.topology.genus, 0);
    ASSERT_TRUE(report.volume.has_value());
    EXPECT_EQ(report.volume->border_voxels, 0u);
    EXPECT_EQ(report.options.cell, bound.smooth > 0 ? 1.0 : 0.0);
  }
}

TEST_F(FromVolume, ASweepIsTheSameAsItsRuns) {
  CleanJob base = job(Voxels::steps, 6);
  const std::vector<RepairReport> reports = sweep(base, {{{3, LengthUnit::cells}, folder_.path("3.stl")}, {{6, LengthUnit::cells}, folder_.path("6.stl")}});
  ASSERT_EQ(reports.size(), 2u);
  for (const RepairReport& r : reports) EXPECT_TRUE(r.written && r.verified) << r.output;
  const RepairReport alone = clean(base);
  EXPECT_NEAR(reports[1].after.volume / alone.after.volume, 1, 1e-4);
}

TEST_F(FromVolume, RecentringMovesSurfaceAndLattice) {
  CleanJob j = job(Voxels::shares, 3);
  const RepairReport there = clean(j);
  j.options.recentre = true;
  const RepairReport moved = clean(j);
  ASSERT_TRUE(moved.written && moved.verified);
  EXPECT_NEAR(moved.after.volume / there.after.volume, 1, 1e-6);
  EXPECT_LT(norm(moved.after.box.center() + moved.recentred_by - there.after.box.center()), 1e-3);
}

}  // namespace
}  // namespace burnish
