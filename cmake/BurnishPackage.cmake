# Debian packages: `cpack --config build/release/CPackConfig.cmake -G DEB`, or the target `package`.
#
# burnish (program, manual page, completions) and libburnish-dev (library, headers, what finds them); python3-burnish where the
# install rules have a component "python". The same sources and tools give the same bytes.
set(BURNISH_MAINTAINER "Burnish maintainers <maintainers@burnish.invalid>" CACHE STRING "Name and address in the control files of packages")
set(BURNISH_HOMEPAGE "" CACHE STRING "Homepage in the control files of packages; none when empty")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME burnish)
set(CPACK_PACKAGE_VENDOR "Burnish")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_HOMEPAGE_URL "${BURNISH_HOMEPAGE}")
# The first line of all descriptions.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "repair and smoothing of triangle meshes")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/debian_documents.cmake")
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_BINARY_DIR}/packaging.cmake")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program development)
get_cmake_property(components COMPONENTS)
if("python" IN_LIST components)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${BURNISH_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME burnish)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Burnish turns a dirty STL, OBJ, PLY or OFF file (holes, cracks, flipped and
overlapping facets, noise) into one that is closed, oriented and free of
self-intersections, and verifies the written file with exact predicates.
Where broken facets cannot be mended in place, the model is rebuilt through
a level set on an adaptive octree.
.
It also compares surfaces, exports distance fields, and fills models with
cells for flow simulation.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libburnish-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(burnish_development_depends g++ libfmt-dev zlib1g-dev libgmp-dev libmpfr-dev)
if(BURNISH_PARALLEL STREQUAL "tbb" OR BURNISH_HAS_OPENVDB)
  list(APPEND burnish_development_depends libtbb-dev)
endif()
if(BURNISH_HAS_OPENVDB)
  list(APPEND burnish_development_depends libopenvdb-dev libimath-dev)
endif()
if(BURNISH_HAS_3MF)
  list(APPEND burnish_development_depends lib3mf-dev)
endif()
if(BURNISH_HAS_CGNS)
  list(APPEND burnish_development_depends libcgns-dev)
endif()
list(JOIN burnish_development_depends ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Burnish repairs triangle meshes: the result is closed, oriented and free of
self-intersections.
.
This package has the static library, its headers, and what CMake and
pkg-config need to find them.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-burnish)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
# The module is compiled for one version of the interpreter.
if(BURNISH_HAS_PYTHON)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}~), python3 (<< ${Python3_VERSION_MAJOR}.${next_minor}~), python3-numpy")
endif()
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Burnish repairs triangle meshes: the result is closed, oriented and free of
self-intersections.
.
This package has the Python module.")

# Times of files and of the changelog: SOURCE_DATE_EPOCH if the environment has it, else the day of the version.
find_program(BURNISH_DATE date)
mark_as_advanced(BURNISH_DATE)
execute_process(COMMAND "${BURNISH_DATE}" -u -d ${BURNISH_VERSION_DATE} +%s OUTPUT_VARIABLE BURNISH_EPOCH OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND "${BURNISH_DATE}" -u -R -d ${BURNISH_VERSION_DATE} OUTPUT_VARIABLE BURNISH_RFC_DATE OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
configure_file(packaging/packaging.cmake.in "${PROJECT_BINARY_DIR}/packaging.cmake" @ONLY)
configure_file(packaging/changelog.in "${PROJECT_BINARY_DIR}/packaging/changelog.Debian" @ONLY)

include(CPack)
