# What `burnish --version` and core/build_info.h tell: build_facts.h is written when the build is configured, build_commit.h when it is built.
#
# burnish_record_dependency(NAME VERSION) adds a row; without a version the library says that it was built without it.
set(BURNISH_COMMIT "AUTO" CACHE STRING "Commit that the version tells: AUTO asks git at each build, NONE tells none, anything else is told as it is")

function(burnish_record_dependency name version)
  set_property(GLOBAL APPEND_STRING PROPERTY BURNISH_DEPENDENCY_ROWS "{\"${name}\", \"${version}\"}, ")
endfunction()

# burnish_header_version(RESULT HEADER PATTERN...): the numbers that the patterns' first groups match in HEADER, with dots between them.
function(burnish_header_version result header)
  set(numbers)
  file(READ "${header}" text)
  foreach(pattern IN LISTS ARGN)
    if(text MATCHES "${pattern}")
      list(APPEND numbers "${CMAKE_MATCH_1}")
    endif()
  endforeach()
  list(JOIN numbers "." version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()

# Writes both headers into `folder` and lets `target` include them.
function(burnish_generate_build_info target folder)
  get_property(BURNISH_DEPENDENCY_ROWS GLOBAL PROPERTY BURNISH_DEPENDENCY_ROWS)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/build_facts.h.in" "${folder}/build_facts.h" @ONLY)
  set(write "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DCOMMIT=${BURNISH_COMMIT}" "-DHEADER=${folder}/build_commit.h"
    -P "${PROJECT_SOURCE_DIR}/cmake/write_commit.cmake")
  if(BURNISH_COMMIT STREQUAL "AUTO")
    # At each build, in milliseconds; what depends on the header is built again only if it changed.
    add_custom_target(burnish_commit COMMAND ${write} BYPRODUCTS "${folder}/build_commit.h" VERBATIM)
    add_dependencies(${target} burnish_commit)
  else()
    execute_process(COMMAND ${write} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  target_include_directories(${target} PRIVATE "${folder}")
endfunction()
