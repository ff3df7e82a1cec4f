# Installs the library, its headers, the program and a package configuration for find_package(burnish).
include(CMakePackageConfigHelpers)

install(TARGETS burnish EXPORT burnishTargets)
install(TARGETS burnish_cli)
install(DIRECTORY include/burnish DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT burnishTargets NAMESPACE burnish:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish)

configure_package_config_file(cmake/burnishConfig.cmake.in
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish)
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/burnishConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/burnishConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/burnish)
