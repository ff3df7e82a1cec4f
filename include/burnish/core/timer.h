// Wall time, CPU time and peak memory of the stages of a run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace burnish {

// What one stage cost. CPU seconds are user + system over all threads.
struct StageCost {
  std::string name;
  double wall_seconds = 0;
  double cpu_seconds = 0;
  std::uint64_t peak_bytes = 0;  // peak resident set of the process up to the stage's end
};

// Seconds of CPU time used by this process so far, over all its threads.
double process_cpu_seconds();
// Seconds on a monotonic clock.
double monotonic_seconds();
// The largest resident set this process has had, in bytes.
std::uint64_t process_peak_bytes();

// Measures consecutive stages: `begin` ends the running stage and starts the next.
class StageClock {
 public:
  void begin(std::string name);
  void end();
  // The finished stages in order.
  const std::vector<StageCost>& stages() const { return stages_; }

 private:
  std::vector<StageCost> stages_;
  bool running_ = false;
  double wall_start_ = 0;
  double cpu_start_ = 0;
};

}  // namespace burnish
