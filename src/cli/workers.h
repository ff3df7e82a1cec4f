// Runs in processes of their own, several at a time.
//
// What one of them does to itself, running out of memory or crashing, the others do not notice; and global state (threads, temporary
// files) is its own.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace burnish {

// How much of the machine a run may take.
struct Share {
  int threads = 0;           // 0: as many as the machine has
  unsigned of_memory = 1;    // one part of so many
};

// What came of a run.
struct WorkerEnd {
  int code = 0;          // its exit code; 70 if it was ended by a signal, or ended without telling anything
  std::string told;      // what it was to hand over
  std::string out, err;  // what it printed, if that was captured
  double seconds = 0;    // wall clock
};

struct WorkerPlan {
  std::size_t count = 0;
  int jobs = 1;      // at a time
  int threads = 0;   // of all together; 0: as many as the machine has
  // Of a run, in its own process: fills in `told` and returns the exit code. Throws nothing.
  std::function<int(std::size_t run, const Share& share, std::string& told)> work;
  // In order of the runs. With one job, `begin` is called before a run starts and its streams are this process'; with more, streams are captured, and `begin` is called when the
  // run's turn to be told of has come.
  std::function<void(std::size_t run)> begin;
  std::function<void(std::size_t run, WorkerEnd& end)> end;
};

// Does all runs. One that ends with exit code 6 while it had a share of the memory only is repeated, alone and with all of it, once the others are done.
// A signal that this process gets is passed on to the runs, in order; then Error{interrupted} is thrown. Runs end when this process is killed.
// All other threads of this process have to be idle. Throws Error{bug} if the system has no more processes or files.
void run_workers(const WorkerPlan& plan);

}  // namespace burnish
