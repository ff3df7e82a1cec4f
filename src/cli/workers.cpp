#include "workers.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/timer.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/report.h"
#include "signals.h"
#include "streams.h"

namespace burnish {
namespace {

constexpr double kSecondsToStop = 5;
constexpr int kPollMilliseconds = 100;  // a signal may come just before the wait for it begins

[[noreturn]] void refuse(std::string_view what) {
  throw Error(ErrorCode::memory_limit, fmt::format("{}: {}", what, std::generic_category().message(errno)), "try again with fewer --jobs");
}

// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close() {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

Descriptor anonymous_file() {
  Descriptor file(::memfd_create("burnish", MFD_CLOEXEC));
  if (file.get() < 0) refuse("no anonymous file");
  return file;
}

std::string text_in(const Descriptor& file) {
  std::string text;
  if (file.get() < 0) return text;
  ::lseek(file.get(), 0, SEEK_SET);
  char buffer[1 << 16];
  for (ssize_t got = 0; (got = ::read(file.get(), buffer, sizeof buffer)) > 0 || (got < 0 && errno == EINTR);)
    if (got > 0) text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

// Nobody waits for the result any more.
extern "C" void end_at_once(int) {
  OutputFile::remove_all_temporaries();
  ::_exit(130);
}

struct Worker {
  pid_t pid = 0;
  double start = 0;
  bool has_all_memory = true;
  Descriptor alive;  // ends with the process
  Descriptor told, out, err;
};

class Crew {
 public:
  explicit Crew(const WorkerPlan& plan) : plan_(plan), captures_(plan.jobs > 1), ends_(plan.count) {
    for (std::size_t i = 0; i < plan.count; ++i) waiting_.push_back(i);
  }
  // Runs that nobody waits for any more end at once, with their temporaries.
  ~Crew() {
    for (const auto& [run, worker] : running_) ::kill(worker.pid, SIGUSR2);
    const double end = monotonic_seconds() + kSecondsToStop;
    for (const auto& [run, worker] : running_) {
      pollfd polled{worker.alive.get(), 0, 0};
      while (monotonic_seconds() < end && ::poll(&polled, 1, kPollMilliseconds) <= 0) continue;
      ::kill(worker.pid, SIGKILL);  // one that has ended is not waited for yet, so the number is its own
      while (::waitpid(worker.pid, nullptr, 0) < 0 && errno == EINTR) continue;
    }
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  void run() {
    while (!waiting_.empty() || !running_.empty() || !to_repeat_.empty()) {
      if (stop_requested()) return stop();
      start_some();
      wait();
      tell();
    }
  }

 private:
  void start_some() {
    while (!waiting_.empty() && running_.size() < static_cast<std::size_t>(plan_.jobs)) {
      start(waiting_.front(), {threads_of_one(), static_cast<unsigned>(plan_.jobs)});
      waiting_.pop_front();
    }
    if (!running_.empty() || to_repeat_.empty()) return;
    start(to_repeat_.front(), {plan_.threads, 1});
    to_repeat_.pop_front();
  }

  int threads_of_one() const {
    if (plan_.jobs == 1) return plan_.threads;
    const int all = plan_.threads > 0 ? plan_.threads : static_cast<int>(std::thread::hardware_concurrency());
    return std::max(1, all / plan_.jobs);
  }

  void start(std::size_t run, const Share& share) {
    if (!captures_) plan_.begin(run);
    Worker worker;
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) refuse("no pipe");
    worker.alive = Descriptor(ends[0]);
    const Descriptor writer(ends[1]);
    worker.told = anonymous_file();
    if (captures_) worker.out = anonymous_file(), worker.err = anonymous_file();
    worker.start = monotonic_seconds();
    worker.has_all_memory = share.of_memory == 1;
    const pid_t parent = ::getpid();
    worker.pid = ::fork();
    if (worker.pid < 0) refuse("no process");
    if (worker.pid == 0) be_worker(run, share, worker, parent);
    running_.emplace(run, std::move(worker));
  }

  // The worker's whole life.
  [[noreturn]] void be_worker(std::size_t run, const Share& share, const Worker& self, pid_t parent) const {
    std::signal(SIGUSR2, end_at_once);
    ::prctl(PR_SET_PDEATHSIG, SIGUSR2);
    if (::getppid() != parent) ::_exit(130);
    if (captures_) ::dup2(self.out.get(), STDOUT_FILENO), ::dup2(self.err.get(), STDERR_FILENO);
    std::string told;
    const int code = plan_.work(run, share, told);
    try {
      write_text(self.told.get(), "the result", told);
    } catch (const Error&) {
      ::_exit(exit_code(ErrorCode::bug));
    }
    ::_exit(code);  // not std::exit: a library that this program links waits, in the end, for threads that a fork does not have
  }

  void wait() {
    std::vector<pollfd> polled;
    for (const auto& [run, worker] : running_) polled.push_back({worker.alive.get(), 0, 0});
    ::poll(polled.data(), polled.size(), kPollMilliseconds);
    std::vector<std::size_t> ended;
    std::size_t at = 0;
    for (const auto& [run, worker] : running_)
      if (polled[at++].revents != 0) ended.push_back(run);
    for (const std::size_t run : ended) take(run);
  }

  void take(std::size_t run) {
    const auto at = running_.find(run);
    const Worker worker = std::move(at->second);
    running_.erase(at);
    int status = 0;
    while (::waitpid(worker.pid, &status, 0) < 0 && errno == EINTR) continue;
    WorkerEnd end{WIFEXITED(status) ? WEXITSTATUS(status) : exit_code(ErrorCode::bug), text_in(worker.told), text_in(worker.out), text_in(worker.err), monotonic_seconds() - worker.start};
    if (end.code == exit_code(ErrorCode::memory_limit) && !worker.has_all_memory) {
      to_repeat_.push_back(run);
      return;
    }
    if (end.code == exit_code(ErrorCode::interrupted)) stopped_by_run_ = true;
    if (WIFSIGNALED(status) || end.told.empty()) tell_of_crash(status, end);
    ends_[run] = std::move(end);
  }

  static void tell_of_crash(int status, WorkerEnd& end) {
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const std::string how = signal == 0 ? fmt::format("the run ended with exit code {}, and told nothing", end.code)
                                        : fmt::format("the run was ended by signal {} ({})", signal, ::strsignal(signal));
    const std::string hint = signal == SIGKILL ? "if nobody killed it, the system has run out of memory: ask for less, with fewer --jobs or larger cells (--cell)"
                                               : "this is a bug of Burnish: please report it with the command and the input file";
    end.code = exit_code(ErrorCode::bug);
    end.told = to_json(Error(ErrorCode::bug, how, hint));
    end.err += fmt::format("burnish: {}\n  hint: {}\n", how, hint);
  }

  void tell() {
    for (; next_ < plan_.count && ends_[next_]; ++next_) {
      if (captures_) plan_.begin(next_);
      plan_.end(next_, *ends_[next_]);
      ends_[next_] = WorkerEnd{};
    }
    if (stopped_by_run_) stop();
  }

  // Lets the runs end in order; those that do not, for they wait for the system, at once: a second request has them remove their temporaries.
  void stop() {
    for (const auto& [run, worker] : running_) ::kill(worker.pid, kStopRequestOfParent);
    for (const double end = monotonic_seconds() + kSecondsToStop; !running_.empty(); wait())
      if (monotonic_seconds() > end)
        for (const auto& [run, worker] : running_) ::kill(worker.pid, SIGTERM);
    throw Error(ErrorCode::interrupted, fmt::format("interrupted after {} of {} files", next_, plan_.count), "what is complete stays: start again with the others");
  }

  const WorkerPlan& plan_;
  const bool captures_;
  std::deque<std::size_t> waiting_, to_repeat_;
  std::map<std::size_t, Worker> running_;
  std::vector<std::optional<WorkerEnd>> ends_;
  std::size_t next_ = 0;  // whose end is to be told next
  bool stopped_by_run_ = false;
};

}  // namespace

void run_workers(const WorkerPlan& plan) {
  obey_stop_requests_of_parent();  // the workers inherit it: there is no moment at which a request would kill one
  Crew(plan).run();
}

}  // namespace burnish
