# Installs the program with its manual page and completions, the library with its headers, and what find_package(burnish)
# and pkg-config need. Components: program, development, and python where the Python module is built.
include(CMakePackageConfigHelpers)

install(TARGETS burnish EXPORT burnishTargets
  ARCHIVE COMPONENT development
  LIBRARY COMPONENT development)
install(TARGETS burnish_cli RUNTIME COMPONENT program)
install(DIRECTORY include/burnish DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT burnishTargets NAMESPACE burnish:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish COMPONENT development)

configure_package_config_file(cmake/burnishConfig.cmake.in
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/burnishConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish COMPONENT development)

# Found from where the file is, so that the prefix may be moved.
file(RELATIVE_PATH BURNISH_PC_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" BURNISH_PC_PREFIX "${BURNISH_PC_PREFIX}")
set(BURNISH_PC_REQUIRES fmt zlib gmp mpfr)
set(BURNISH_PC_LIBS -lm -pthread)
if(BURNISH_HAS_OPENVDB)
  list(APPEND BURNISH_PC_REQUIRES Imath tbb)
  list(PREPEND BURNISH_PC_LIBS -lopenvdb)
elseif(BURNISH_PARALLEL STREQUAL "tbb")
  list(APPEND BURNISH_PC_REQUIRES tbb)
endif()
if(BURNISH_HAS_3MF)
  list(PREPEND BURNISH_PC_LIBS -l3MF)
endif()
if(BURNISH_HAS_CGNS)
  list(PREPEND BURNISH_PC_LIBS -lcgns)
endif()
list(JOIN BURNISH_PC_REQUIRES " " BURNISH_PC_REQUIRES)
list(JOIN BURNISH_PC_LIBS " " BURNISH_PC_LIBS)
configure_file(cmake/burnish.pc.in "${CMAKE_CURRENT_BINARY_DIR}/burnish.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/burnish.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

include(BurnishManuals)

install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

add_custom_target(uninstall COMMAND "${CMAKE_COMMAND}" "-DMANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt" -P "${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake" VERBATIM)
