// What Python sees of a run while it lasts: a callback, Ctrl-C, and a limit to its time.
//
// The run goes without the interpreter's lock (the GIL). The thread that has started it takes the lock every now and then, where the run asks whether it is to
// stop; no other thread ever does, so that one which waits for the lock holds up nobody.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string_view>

#include "burnish/core/progress.h"

namespace burnish {

class PythonProgress : public Progress {
 public:
  // With the GIL, by the thread that will run. `callback(stage, fraction)` may be None; `seconds` from now on.
  PythonProgress(pybind11::object callback, std::optional<double> seconds);
  // With the GIL.
  ~PythonProgress() override;

  void begin_stage(std::string_view name) override;
  void update(double fraction) override;
  bool cancelled() const override;
  bool out_of_time() const override;

  // With the GIL, behind the run: throws what stopped it, KeyboardInterrupt or what the callback has raised. Nothing did: returns.
  void rethrow() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace burnish
