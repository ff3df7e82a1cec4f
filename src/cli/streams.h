// The three standard streams, without surprises: data goes out completely or with an error, messages
// never fail a run.
#pragma once

#include <string>
#include <string_view>

namespace burnish {

// Gives descriptors 0 to 2 that the caller has closed a stand-in that refuses every byte, so that no
// file opened later can become "standard output" by accident.
void occupy_standard_streams();

bool is_terminal(int fd);

// Writes all of `text`. Throws Error{unwritable_output}, naming `label`.
void write_text(int fd, const std::string& label, std::string_view text);
// Writes all of `text` to standard output. Throws Error{unwritable_output}.
void write_stdout(std::string_view text);
// The same as far as it is possible, for an ending that has an error of its own already.
void write_stdout_if_possible(std::string_view text) noexcept;
// Writes to standard error as far as that is possible.
void write_stderr(std::string_view text) noexcept;

}  // namespace burnish
