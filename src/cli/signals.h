// Ctrl-C, in two steps.
#pragma once

namespace burnish {

// From now on the first SIGINT, SIGTERM or SIGHUP only raises the flag below, so that the run can end in
// order; the second removes all temporary files and ends the process at once with exit code 130.
// SIGPIPE is ignored: a closed pipe is an error of the write that meets it.
void install_signal_handlers();

// True once the user has asked to stop. Any thread may ask.
bool stop_requested();

}  // namespace burnish
