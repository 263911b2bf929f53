# Run by `cmake --install`.
# Headers are installed as obliq/client/... and obliq/proto/..., and include each other so: no user's folder of such a name
# is in the way.
file(GLOB headers RELATIVE "@PROJECT_SOURCE_DIR@"
  "@PROJECT_SOURCE_DIR@/client/*.h" "@PROJECT_SOURCE_DIR@/client/recording/*.h" "@PROJECT_SOURCE_DIR@/proto/*.h" "@PROJECT_SOURCE_DIR@/client/examples/*.cpp")
foreach(header IN LISTS headers)
  file(READ "@PROJECT_SOURCE_DIR@/${header}" text)
  string(REGEX REPLACE "#include \"(client|proto)/" "#include \"obliq/\\1/" text "${text}")
  set(folder "@CMAKE_INSTALL_INCLUDEDIR@/obliq")
  if(header MATCHES "examples/")
    set(folder "@CMAKE_INSTALL_DATADIR@/obliq")
  endif()
  set(to "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${folder}/${header}")
  file(WRITE "${to}" "${text}")
  message(STATUS "Installing: ${to}")
endforeach()

set(to "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/@CMAKE_INSTALL_LIBDIR@/pkgconfig/obliq.pc")
file(WRITE "${to}" "prefix=${CMAKE_INSTALL_PREFIX}
libdir=\${prefix}/@CMAKE_INSTALL_LIBDIR@
includedir=\${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: obliq
Description: Client of obliqd, the radar ground-map simulator
Version: @PROJECT_VERSION@
Requires: protobuf
@OBLIQ_PC_PRIVATE@: libisal libzstd libssl
Cflags: -I\${includedir}
Libs: -L\${libdir} @OBLIQ_PC_LIBS@
")
message(STATUS "Installing: ${to}")
