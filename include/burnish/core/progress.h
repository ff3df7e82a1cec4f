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

  // True once the run has taken longer than it may.
  virtual bool out_of_time() const { return false; }

  // Throws Error{interrupted} once the user has asked to stop, Error{time_limit} once it is out of time. Stages call it every few milliseconds.
  void check() const;
};

// For a stage within another: it may be stopped, and reports no progress of its own.
class QuietProgress : public Progress {
 public:
  explicit QuietProgress(const Progress& whole) : whole_(whole) {}
  bool cancelled() const override { return whole_.cancelled(); }
  bool out_of_time() const override { return whole_.out_of_time(); }

 private:
  const Progress& whole_;
};

// A Progress that reports to nobody, for calls that need none.
Progress& no_progress();

}  // namespace burnish
