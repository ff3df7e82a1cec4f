// Progress and cancellation: how a long stage talks to whoever started it.
#pragma once

#include <string_view>

namespace burnish {

// Passed by reference into long stages. The default does nothing and is never cancelled; the command
// line draws a bar with it. `update` may be called from any thread and must be cheap.
class Progress {
 public:
  virtual ~Progress() = default;
  // A stage starts. `name` is a short lower-case phrase, e.g. "exact distances".
  virtual void begin_stage(std::string_view name) { static_cast<void>(name); }
  // The running stage is `fraction` done, in [0, 1].
  virtual void update(double fraction) { static_cast<void>(fraction); }
  // True once the user has asked to stop.
  virtual bool cancelled() const { return false; }

  // Throws Error{interrupted} once the user has asked to stop. Stages call it every few milliseconds.
  void check() const;
};

// A Progress that reports to nobody, for calls that need none.
Progress& no_progress();

}  // namespace burnish
