#include "signals.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "burnish/io/output_file.h"

namespace burnish {
namespace {

std::atomic<int> g_requests{0};
static_assert(std::atomic<int>::is_always_lock_free, "the signal handler relies on it");

extern "C" void on_stop_signal(int) {
  if (g_requests.fetch_add(1) == 0) return;
  OutputFile::remove_all_temporaries();
  _exit(130);
}

extern "C" void on_request_of_parent(int) {
  int none = 0;
  g_requests.compare_exchange_strong(none, 1);
}

}  // namespace

void obey_stop_requests_of_parent() {
  struct sigaction action {};
  action.sa_handler = on_request_of_parent;
  sigemptyset(&action.sa_mask);
  sigaction(kStopRequestOfParent, &action, nullptr);
}

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  // No SA_RESTART: a read that waits for standard input must wake up.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction inherited {};
    sigaction(signal, nullptr, &inherited);
    // `nohup` and background jobs of scripts hand these signals down ignored; that is to stay so.
    if (inherited.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() { return g_requests.load(std::memory_order_relaxed) > 0; }

}  // namespace burnish
