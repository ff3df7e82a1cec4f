# Writes what PROGRAM prints for ARGUMENTS to OUTPUT, compressed by GZIP if that is given, without a time or a name in it.
execute_process(COMMAND ${EMULATOR} "${PROGRAM}" ${ARGUMENTS} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
if(GZIP)
  string(REGEX REPLACE "\\.gz$" "" OUTPUT "${OUTPUT}")
endif()
file(WRITE "${OUTPUT}" "${text}")
if(GZIP)
  execute_process(COMMAND "${GZIP}" -9nf "${OUTPUT}" COMMAND_ERROR_IS_FATAL ANY)
endif()
