// Ctrl-C, in two steps.
#pragma once

#include <csignal>

namespace burnish {

// From now on the first SIGINT, SIGTERM or SIGHUP only raises the flag below, so that the run can end in
// order; the second removes all temporary files and ends the process at once with exit code 130.
// SIGPIPE is ignored: a closed pipe is an error of the write that meets it.
void install_signal_handlers();

// What a process sends to those that work for it, to pass on that it is to stop. However often it comes, it counts as one
// request, for the user's own may have come as well: Ctrl-C reaches all processes of a terminal.
inline constexpr int kStopRequestOfParent = SIGUSR1;
// From now on this process obeys it.
void obey_stop_requests_of_parent();

// True once the user has asked to stop. Any thread may ask.
bool stop_requested();

}  // namespace burnish
