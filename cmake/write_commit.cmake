# Writes HEADER with the commit of the sources in SOURCE, if it changed. COMMIT: AUTO, NONE, or the text itself.
cmake_minimum_required(VERSION 3.25)
set(commit "${COMMIT}")
if(COMMIT STREQUAL "NONE")
  set(commit "")
elseif(COMMIT STREQUAL "AUTO")
  set(commit "$ENV{BURNISH_COMMIT}")
  # Not that of another project that has this one's sources in a folder.
  if(commit STREQUAL "" AND EXISTS "${SOURCE}/.git")
    find_program(git git)
    if(git)
      execute_process(COMMAND "${git}" -C "${SOURCE}" rev-parse --short=12 HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      execute_process(COMMAND "${git}" -C "${SOURCE}" status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
      if(commit AND changes)
        string(APPEND commit "-dirty")
      endif()
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${HEADER}" CONTENT [==[// Written by cmake/write_commit.cmake.
#pragma once

#include <string_view>

namespace burnish {
inline constexpr std::string_view kCommit = "@commit@";
}  // namespace burnish
]==] @ONLY)
