# Builds the programs of docs/library.md, its ```cpp blocks, against an installed Burnish, and runs them. Expects what run.cmake expects, and PAGE.
set(prefix "${WORK}/prefix")
file(REMOVE_RECURSE "${WORK}")

# run(COMMAND...) stops the test when the command fails.
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
endfunction()

# The blocks, one after the other; semicolons and brackets would be taken for lists.
file(READ "${PAGE}" rest)
set(project "cmake_minimum_required(VERSION 3.25)\nproject(tutorial LANGUAGES CXX)\nfind_package(burnish REQUIRED)\n")
set(count 0)
string(FIND "${rest}" "```cpp\n" at)
while(NOT at EQUAL -1)
  math(EXPR at "${at} + 7")
  string(SUBSTRING "${rest}" ${at} -1 rest)
  string(FIND "${rest}" "```" end)
  string(SUBSTRING "${rest}" 0 ${end} program)
  math(EXPR count "${count} + 1")
  file(WRITE "${WORK}/source/program${count}.cpp" "${program}")
  string(APPEND project "add_executable(program${count} program${count}.cpp)\ntarget_link_libraries(program${count} PRIVATE burnish::burnish)\n")
  math(EXPR end "${end} + 3")
  string(SUBSTRING "${rest}" ${end} -1 rest)
  string(FIND "${rest}" "```cpp\n" at)
endwhile()
if(NOT count EQUAL 3)
  message(FATAL_ERROR "${PAGE}: expected three programs, found ${count}")
endif()
file(WRITE "${WORK}/source/CMakeLists.txt" "${project}")

run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")
run("${CMAKE_COMMAND}" -S "${WORK}/source" -B "${WORK}/build" -G "${GENERATOR}"
  "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${FLAGS}"
  "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run("${CMAKE_COMMAND}" --build "${WORK}/build")
foreach(number RANGE 1 ${count})
  run("${WORK}/build/program${number}")
endforeach()
file(REMOVE_RECURSE "${WORK}")
