# Run by `cmake --install`.
foreach(unit obliqd.service obliq-cat240@.service)
  file(READ "@CMAKE_CURRENT_SOURCE_DIR@/${unit}" text)
  string(REPLACE "/usr/local/bin/" "${CMAKE_INSTALL_PREFIX}/@CMAKE_INSTALL_BINDIR@/" text "${text}")
  string(REPLACE "/usr/share/doc/obliq/" "${CMAKE_INSTALL_PREFIX}/@CMAKE_INSTALL_DOCDIR@/" text "${text}")
  set(to "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/lib/systemd/system/${unit}")
  file(WRITE "${to}" "${text}")
  message(STATUS "Installing: ${to}")
endforeach()
