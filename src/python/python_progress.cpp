#include "python_progress.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "arrays.h"
#include "burnish/core/timer.h"

namespace burnish {
namespace {

// Rarely enough for a thread of Python that computes meanwhile to give way without costing the run anything, often enough for Ctrl-C.
constexpr double kSecondsBetweenLooks = 0.1;

}  // namespace

struct PythonProgress::State {
  pybind11::object callback;
  double end = 0;  // 0: never
  const std::thread::id caller = std::this_thread::get_id();
  double next_look = 0;  // the caller's

  std::mutex mutex;
  std::string stage;
  std::atomic<double> fraction{0};
  std::atomic<bool> stopped{false};
  std::exception_ptr reason;

  bool is_caller() const { return std::this_thread::get_id() == caller; }

  void look() {
    if (stopped) return;
    next_look = monotonic_seconds() + kSecondsBetweenLooks;
    const pybind11::gil_scoped_acquire gil;
    try {
      if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
      tell();
    } catch (...) {
      reason = std::current_exception();
      stopped = true;
    }
  }

  void tell() {
    if (callback.is_none()) return;
    std::string name;
    {
      const std::lock_guard lock(mutex);
      name = stage;
    }
    if (!name.empty()) callback(text_of(name, "backslashreplace"), fraction.load());
  }
};

PythonProgress::PythonProgress(pybind11::object callback, std::optional<double> seconds) : state_(std::make_unique<State>()) {
  state_->callback = std::move(callback);
  if (seconds) state_->end = monotonic_seconds() + *seconds;
}

PythonProgress::~PythonProgress() = default;

void PythonProgress::begin_stage(std::string_view name) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stage = name;
    state_->fraction = 0;
  }
  if (state_->is_caller()) state_->look();
}

void PythonProgress::update(double fraction) { state_->fraction.store(fraction, std::memory_order_relaxed); }

bool PythonProgress::cancelled() const {
  if (state_->is_caller() && monotonic_seconds() >= state_->next_look) state_->look();
  return state_->stopped;
}

bool PythonProgress::out_of_time() const { return state_->end > 0 && monotonic_seconds() > state_->end; }

void PythonProgress::rethrow() const {
  if (state_->reason) std::rethrow_exception(std::exchange(state_->reason, nullptr));
}

}  // namespace burnish
