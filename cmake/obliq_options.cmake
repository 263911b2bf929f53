# One interface target carries the flags that every obliq library is built with.
find_program(OBLIQ_CCACHE ccache)
if(OBLIQ_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${OBLIQ_CCACHE})
endif()

add_library(obliq_options INTERFACE)
target_include_directories(obliq_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
target_compile_options(obliq_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Werror
  -ffp-contract=off) # the same bits whether or not the machine has fused multiply-add
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(obliq_options INTERFACE -Wno-restrict) # false alarm on "text" + std::string, GCC bug 105651
endif()
target_compile_definitions(obliq_options INTERFACE GLM_FORCE_XYZW_ONLY GLM_FORCE_EXPLICIT_CTOR)

# obliq_library(NAME sources... [LINK libraries...]): a static library with the project's flags.
function(obliq_library name)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC obliq_options ${ARG_LINK})
endfunction()
