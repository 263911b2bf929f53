# Run by `cmake --install`.
file(STRINGS "@PROJECT_BINARY_DIR@/server/apps/version.cpp" line REGEX "return \"")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" version "${line}")
set(to "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/@CMAKE_INSTALL_DOCDIR@")
file(MAKE_DIRECTORY "${to}")
execute_process(COMMAND "@Python3_EXECUTABLE@" "@CMAKE_CURRENT_SOURCE_DIR@/sbom.py" "${version}"
    "@CMAKE_RUNTIME_OUTPUT_DIRECTORY@/obliqd" "@CMAKE_RUNTIME_OUTPUT_DIRECTORY@/obliq"
  OUTPUT_FILE "${to}/obliq.spdx.json" COMMAND_ERROR_IS_FATAL ANY)
message(STATUS "Installing: ${to}/obliq.spdx.json")
