# The Python package, which is optional: burnish_find_python() sets BURNISH_HAS_PYTHON, and PYBIND11_INCLUDE_DIR.
set(BURNISH_BUILD_PYTHON "AUTO" CACHE STRING "Build the Python package: AUTO (where pybind11-dev and python3-dev are found), ON or OFF")
set_property(CACHE BURNISH_BUILD_PYTHON PROPERTY STRINGS AUTO ON OFF)

# Debian's own interpreter, where there is one: no other sees Debian's Python packages.
if(NOT DEFINED Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()

macro(burnish_find_python)
  set(BURNISH_HAS_PYTHON OFF)
  # An interpreter without a sanitizer's runtime cannot load a module that needs it.
  if(BURNISH_BUILD_PYTHON STREQUAL "AUTO" AND (CMAKE_CXX_FLAGS MATCHES "-fsanitize" OR BURNISH_BUILD_FUZZERS))
    message(STATUS "Built with a sanitizer: without the Python package")
  elseif(NOT BURNISH_BUILD_PYTHON STREQUAL "OFF")
    find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module)
    find_path(PYBIND11_INCLUDE_DIR pybind11/pybind11.h)
    if(Python3_Development.Module_FOUND AND PYBIND11_INCLUDE_DIR)
      set(BURNISH_HAS_PYTHON ON)
      # Debian's own interpreter looks into these two.
      if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
        set(burnish_dist_packages "lib/python3/dist-packages")
      else()
        set(burnish_dist_packages "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/dist-packages")
      endif()
      set(BURNISH_PYTHON_INSTALL_DIR "${burnish_dist_packages}" CACHE STRING "Where the Python package is installed, relative to the prefix")
    elseif(BURNISH_BUILD_PYTHON STREQUAL "ON")
      message(FATAL_ERROR "BURNISH_BUILD_PYTHON is ON and pybind11 or Python's headers were not found: install pybind11-dev and python3-dev")
    else()
      message(STATUS "pybind11 or Python's headers not found (pybind11-dev, python3-dev): built without the Python package")
    endif()
  endif()
endmacro()

# Compiles a static library so that a module can link it. What is not to be interposed is inlined as ever, and a program that links it
# gets its addresses settled by the linker: it costs the program nothing that can be measured (docs/benchmarks.md).
function(burnish_position_independent target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
endfunction()
