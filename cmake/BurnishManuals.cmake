# The manual page and the completions: the program prints them of its option tables, when it was built and can be run.
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "Cross compiling: installed without manual page and completions, which the program itself prints")
  return()
endif()

set(manuals "${PROJECT_BINARY_DIR}/manuals")
find_program(BURNISH_GZIP gzip)
mark_as_advanced(BURNISH_GZIP)

# burnish_printed_file(FOLDER/FILE DESTINATION ARGUMENTS...): a file of what the program prints, and where it is installed.
function(burnish_printed_file file destination)
  set(output "${manuals}/${file}")
  set(compress "")
  if(file MATCHES "\\.gz$")
    set(compress "-DGZIP=${BURNISH_GZIP}")
  endif()
  add_custom_command(OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DPROGRAM=$<TARGET_FILE:burnish_cli>" "-DEMULATOR=${CMAKE_CROSSCOMPILING_EMULATOR}" "-DARGUMENTS=${ARGN}"
      "-DOUTPUT=${output}" ${compress} -P "${PROJECT_SOURCE_DIR}/cmake/print_to_file.cmake"
    DEPENDS burnish_cli "${PROJECT_SOURCE_DIR}/cmake/print_to_file.cmake" VERBATIM)
  set_property(GLOBAL APPEND PROPERTY BURNISH_PRINTED_FILES "${output}")
  install(FILES "${output}" DESTINATION "${destination}" COMPONENT program)
endfunction()

# Compressed, as Debian has it, where there is a gzip.
if(BURNISH_GZIP)
  burnish_printed_file(burnish.1.gz "${CMAKE_INSTALL_MANDIR}/man1" man)
else()
  burnish_printed_file(burnish.1 "${CMAKE_INSTALL_MANDIR}/man1" man)
endif()
burnish_printed_file(bash/burnish "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" completion bash)
burnish_printed_file(zsh/_burnish "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" completion zsh)
burnish_printed_file(fish/burnish.fish "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" completion fish)

get_property(printed GLOBAL PROPERTY BURNISH_PRINTED_FILES)
add_custom_target(burnish_manuals ALL DEPENDS ${printed})
