#include "burnish/core/timer.h"

#include <sys/resource.h>

#include <chrono>
#include <utility>

namespace burnish {
namespace {

rusage usage() {
  rusage r{};
  getrusage(RUSAGE_SELF, &r);
  return r;
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

}  // namespace

double process_cpu_seconds() {
  const rusage r = usage();
  return seconds(r.ru_utime) + seconds(r.ru_stime);
}

double monotonic_seconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

std::uint64_t process_peak_bytes() { return static_cast<std::uint64_t>(usage().ru_maxrss) * 1024; }

void StageClock::begin(std::string name) {
  end();
  stages_.push_back({std::move(name), 0, 0, 0});
  running_ = true;
  wall_start_ = monotonic_seconds();
  cpu_start_ = process_cpu_seconds();
}

void StageClock::end() {
  if (!running_) return;
  StageCost& stage = stages_.back();
  stage.wall_seconds = monotonic_seconds() - wall_start_;
  stage.cpu_seconds = process_cpu_seconds() - cpu_start_;
  stage.peak_bytes = process_peak_bytes();
  running_ = false;
}

}  // namespace burnish
