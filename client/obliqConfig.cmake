# find_package(obliq): the target obliq::client, and what it is linked with.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Protobuf)
if(NOT "@BUILD_SHARED_LIBS@") # a shared library knows the rest itself
  find_dependency(OpenSSL 3)
  if(WIN32) # what a static OpenSSL calls; we call winsock, too
    set_property(TARGET OpenSSL::Crypto APPEND PROPERTY INTERFACE_LINK_LIBRARIES ws2_32 crypt32)
  endif()
  find_dependency(PkgConfig)
  pkg_check_modules(ISAL REQUIRED QUIET IMPORTED_TARGET libisal)
  pkg_check_modules(ZSTD REQUIRED QUIET IMPORTED_TARGET libzstd)
endif()
include("${CMAKE_CURRENT_LIST_DIR}/obliqTargets.cmake")
