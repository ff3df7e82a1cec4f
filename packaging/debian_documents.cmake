# Run by cpack when all components are staged: adds what every Debian package has under /usr/share/doc,
# puts the Python module where Debian has those of packages, and gives each file its time.
# Folders of components and the packages that are made of them:
set(package_of_program burnish)
set(package_of_development libburnish-dev)
set(package_of_python python3-burnish)

# write_compressed(SOURCE OUTPUT): OUTPUT.gz, without a time or a name in it.
function(write_compressed source output)
  file(COPY_FILE "${source}" "${output}")
  execute_process(COMMAND "${BURNISH_PACKAGING_GZIP}" -9nf "${output}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component program development python)
  set(root "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component}")
  if(NOT IS_DIRECTORY "${root}")
    continue()
  endif()
  set(documents "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share/doc/${package_of_${component}}")
  file(MAKE_DIRECTORY "${documents}")
  # Where packages of Debian have modules, whatever the prefix that the build was configured with.
  file(GLOB versioned "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/lib/python3.*")
  if(versioned)
    file(RENAME "${versioned}" "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/lib/python3")
  endif()
  file(COPY_FILE "${BURNISH_PACKAGING_SOURCE}/packaging/copyright" "${documents}/copyright")
  write_compressed("${BURNISH_PACKAGING_SOURCE}/CHANGELOG.md" "${documents}/changelog")
  write_compressed("${BURNISH_PACKAGING_CHANGELOG}" "${documents}/changelog.Debian")
  file(GLOB_RECURSE files LIST_DIRECTORIES true "${root}/*")
  execute_process(COMMAND touch -h -d "@$ENV{SOURCE_DATE_EPOCH}" "${root}" ${files} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND chmod -R u=rwX,go=rX "${root}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
