# What every target of the project has in common: language level, warnings, and floating point that
# gives the same bits on every run (no contraction of a*b+c, no reassociation).
add_library(burnish_build_flags INTERFACE)
target_compile_features(burnish_build_flags INTERFACE cxx_std_20)
target_compile_options(burnish_build_flags INTERFACE
  -ffp-contract=off
  # GCC 12 drops double -> float -> double on struct members when it vectorises straight-line code.
  $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<BOOL:${BURNISH_WARNINGS_AS_ERRORS}>:-Werror>)

# CGAL's and TBB's headers are not ours to warn about.
function(burnish_system_headers target)
  foreach(package IN LISTS ARGN)
    get_target_property(dirs ${package} INTERFACE_INCLUDE_DIRECTORIES)
    if(dirs)
      target_include_directories(${target} SYSTEM PRIVATE ${dirs})
    endif()
  endforeach()
endfunction()
