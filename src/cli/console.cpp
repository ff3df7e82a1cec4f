#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "burnish/core/timer.h"
#include "signals.h"
#include "streams.h"

namespace burnish {
namespace {

constexpr double kSecondsBetweenDraws = 0.1;
constexpr int kBarWidth = 30;
constexpr std::string_view kClearLine = "\r\x1b[K";

bool can_draw_bar() {
  const char* const terminal = std::getenv("TERM");
  return is_terminal(STDERR_FILENO) && terminal != nullptr && std::string_view(terminal) != "dumb";
}

}  // namespace

Console::Console(Verbosity verbosity) : verbosity_(verbosity), bar_(can_draw_bar()) {}

void Console::begin_stage(std::string_view name) {
  end_stage();
  const std::lock_guard lock(mutex_);
  stage_ = name;
  stage_start_ = monotonic_seconds();
  if (verbosity_ == Verbosity::quiet) return;
  if (verbosity_ == Verbosity::brief && !bar_) return;
  // Without a terminal the line is begun now, so that a log shows what a long run is busy with.
  if (bar_)
    draw(0);
  else
    write_stderr(fmt::format("  {:<32}", stage_));
}

void Console::update(double fraction) {
  if (!bar_ || verbosity_ == Verbosity::quiet) return;
  if (monotonic_seconds() < next_draw_.load(std::memory_order_relaxed)) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && !stage_.empty()) draw(fraction);
}

bool Console::cancelled() const { return stop_requested(); }

void Console::stop_after(double seconds) { end_ = monotonic_seconds() + seconds; }

bool Console::out_of_time() const { return end_ > 0 && monotonic_seconds() > end_; }

void Console::end_stage() {
  const std::lock_guard lock(mutex_);
  if (stage_.empty()) return;
  const double seconds = monotonic_seconds() - stage_start_;
  if (verbosity_ != Verbosity::quiet) {
    if (bar_) write_stderr(kClearLine);
    if (bar_ && verbosity_ == Verbosity::verbose) write_stderr(fmt::format("  {:<32}", stage_));
    if ((!bar_ && verbosity_ != Verbosity::brief) || verbosity_ == Verbosity::verbose) write_stderr(fmt::format("{:8.2f} s\n", seconds));
  }
  stage_.clear();
}

void Console::warn(std::string_view label, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) say(fmt::format("burnish: warning: {}: {}\n", label, warning));
}

void Console::say(std::string_view text) {
  end_stage();
  if (verbosity_ != Verbosity::quiet) write_stderr(text);
}

void Console::draw(double fraction) {
  next_draw_ = monotonic_seconds() + kSecondsBetweenDraws;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(part * kBarWidth);
  write_stderr(fmt::format("{}[{:#<{}}{:.<{}}] {:3.0f}%  {}{}", kClearLine, "", filled, "",
                           kBarWidth - filled, 100 * part, stage_, stop_requested() ? " (stopping)" : ""));
}

}  // namespace burnish
