# Installs the build into a folder of its own, builds tests/consumer against it, and runs both it and the
# installed program. Expects BUILD, WORK, GENERATOR, COMPILER, FLAGS and BUILD_TYPE.
set(prefix "${WORK}/prefix")
file(REMOVE_RECURSE "${WORK}")

# run(COMMAND...) stops the test when the command fails.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")
run("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${WORK}/build" -G "${GENERATOR}"
  "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${FLAGS}"
  "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run("${CMAKE_COMMAND}" --build "${WORK}/build")
run("${WORK}/build/consumer")
run("${prefix}/bin/burnish" --version)

# A version of another interface is refused.
file(WRITE "${WORK}/refused/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\nfind_package(burnish 0.0 REQUIRED)\n")
execute_process(COMMAND "${CMAKE_COMMAND}" -S "${WORK}/refused" -B "${WORK}/refused/build" -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}"
  "-DCMAKE_CXX_COMPILER=${COMPILER}" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE error)
if(result EQUAL 0 OR NOT error MATCHES "compatible with requested version")
  message(FATAL_ERROR "find_package(burnish 0.0) was not refused:\n${error}")
endif()

# The same program without CMake, in a prefix that was moved since.
find_program(pkg_config pkg-config)
if(pkg_config)
  file(RENAME "${prefix}" "${WORK}/moved")
  file(GLOB_RECURSE pc "${WORK}/moved/*burnish.pc")
  get_filename_component(pc_folder "${pc}" DIRECTORY)
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env "PKG_CONFIG_PATH=${pc_folder}:$ENV{PKG_CONFIG_PATH}" "${pkg_config}" --cflags --libs --static burnish
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  separate_arguments(compiler_flags UNIX_COMMAND "${FLAGS}")
  run("${COMPILER}" ${compiler_flags} -std=c++20 "${CMAKE_CURRENT_LIST_DIR}/main.cpp" ${flags} -o "${WORK}/by_pkg_config")
  run("${CMAKE_COMMAND}" -E env "LD_LIBRARY_PATH=${WORK}/moved/lib:$ENV{LD_LIBRARY_PATH}" "${WORK}/by_pkg_config")
else()
  message("skipped: no pkg-config (scripts/bootstrap test)")
endif()
file(REMOVE_RECURSE "${WORK}")
