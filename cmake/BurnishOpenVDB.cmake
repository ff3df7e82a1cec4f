# OpenVDB, which is optional: burnish_find_openvdb() sets BURNISH_HAS_OPENVDB, and BURNISH_OPENVDB_VERSION, OPENVDB_INCLUDE_DIR and OPENVDB_LIBRARY.
#
# Debian's OpenVDB has no configuration for CMake, only a find module in a place of its own. Its headers need those of Imath and TBB.
set(BURNISH_WITH_OPENVDB "AUTO" CACHE STRING "Write .vdb files: AUTO (where libopenvdb-dev is found), ON or OFF")
set_property(CACHE BURNISH_WITH_OPENVDB PROPERTY STRINGS AUTO ON OFF)

macro(burnish_find_openvdb)
  set(BURNISH_HAS_OPENVDB OFF)
  if(NOT BURNISH_WITH_OPENVDB STREQUAL "OFF")
    find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
    find_library(OPENVDB_LIBRARY openvdb)
    find_package(TBB CONFIG QUIET)
    # Debian's configuration complains of a part for Python that nobody here asks for.
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    find_package(Imath CONFIG QUIET)
    unset(CMAKE_MESSAGE_LOG_LEVEL)
    if(OPENVDB_INCLUDE_DIR AND OPENVDB_LIBRARY AND TBB_FOUND AND Imath_FOUND)
      set(BURNISH_HAS_OPENVDB ON)
      burnish_header_version(BURNISH_OPENVDB_VERSION "${OPENVDB_INCLUDE_DIR}/openvdb/version.h" "LIBRARY_MAJOR_VERSION_NUMBER ([0-9]+)"
        "LIBRARY_MINOR_VERSION_NUMBER ([0-9]+)" "LIBRARY_PATCH_VERSION_NUMBER ([0-9]+)")
    elseif(BURNISH_WITH_OPENVDB STREQUAL "ON")
      message(FATAL_ERROR "BURNISH_WITH_OPENVDB is ON and OpenVDB was not found: install libopenvdb-dev, libimath-dev and libtbb-dev")
    else()
      message(STATUS "OpenVDB not found (libopenvdb-dev): built without .vdb files")
    endif()
  endif()
endmacro()

# Lets a target include OpenVDB's headers.
function(burnish_include_openvdb target)
  target_include_directories(${target} SYSTEM PRIVATE "${OPENVDB_INCLUDE_DIR}")
  burnish_system_headers(${target} Imath::Imath TBB::tbb)
endfunction()

# Lets a target link OpenVDB, which changes nothing of how it is compiled.
function(burnish_link_openvdb target)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${OPENVDB_LIBRARY}> $<INSTALL_INTERFACE:openvdb> $<LINK_ONLY:TBB::tbb> $<LINK_ONLY:Imath::Imath>)
endfunction()
