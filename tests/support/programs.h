// Other people's programs, where they are installed.
#pragma once

#include <stdio.h>

#include <array>
#include <cstdlib>
#include <string>

namespace burnish::test {

struct Ran {
  int status = -1;
  std::string output;  // and what it says on the error stream
};

inline Ran run_program(const std::string& command) {
  Ran ran;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return ran;
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = ::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) ran.output.append(buffer.data(), n);
  ran.status = ::pclose(pipe);
  return ran;
}

inline bool has_program(const std::string& name) { return run_program("command -v " + name).status == 0; }

// Debian's programs of OpenFOAM look for their settings where this variable says.
inline Ran run_foam(const std::string& program, const std::string& case_folder, const std::string& options = {}) {
  return run_program("WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} " + program + " -case '" + case_folder + "' " + options);
}

}  // namespace burnish::test
