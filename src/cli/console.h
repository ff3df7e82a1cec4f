// What the user sees while a run lasts. Everything here goes to standard error.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"

namespace burnish {

// `brief`: of one run among many, without a line per stage.
enum class Verbosity { quiet, brief, normal, verbose };

// A Progress that draws: on a terminal one bar, redrawn ten times a second and gone at the end
// (`verbose` leaves a line per stage); elsewhere a line per stage with its seconds. `quiet` draws
// nothing. Cancelled once the user has pressed Ctrl-C.
class Console : public Progress {
 public:
  explicit Console(Verbosity verbosity);
  ~Console() override { end_stage(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void begin_stage(std::string_view name) override;
  void update(double fraction) override;
  bool cancelled() const override;
  bool out_of_time() const override;

  // From now on, the run may take this many seconds.
  void stop_after(double seconds);

  // Ends the running stage's bar or line, if there is one: call before printing anything else.
  void end_stage();

  // Both end the running stage and print unless quiet, a warning as `burnish: warning: label: ...`.
  void warn(std::string_view label, const std::vector<std::string>& warnings);
  void say(std::string_view text);

 private:
  void draw(double fraction);

  const Verbosity verbosity_;
  const bool bar_;  // draw on a terminal
  std::mutex mutex_;
  std::string stage_;
  double stage_start_ = 0;
  double end_ = 0;  // when the run is out of time; 0: never
  std::atomic<double> next_draw_{0};
};

}  // namespace burnish
