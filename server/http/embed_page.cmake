# Turns the files of the page into a C++ source:
#   cmake -D "FILES=a.html;b.js" -D OUT=page_bytes.cpp -P embed_page.cmake
# Scripts and styles are served without indentation, blank lines and comments. So no text of a script has " // " or "/** ".
set(arrays "")
set(rows "")
set(number 0)
foreach(file IN LISTS FILES)
  file(RELATIVE_PATH name ${CMAKE_CURRENT_LIST_DIR}/page ${file})
  if(name MATCHES "\\.(js|css)$")
    file(READ ${file} text)
    string(REGEX REPLACE "\n[ \t]+" "\n" text "\n${text}")
    string(REGEX REPLACE "\n/\\*([^*]|\\*+[^*/])*\\*+/" "" text "${text}")
    string(REGEX REPLACE "\n//[^\n]*" "" text "${text}")
    string(REGEX REPLACE "/\\*\\* [^*\n]*\\*/ ?" "" text "${text}")
    string(REGEX REPLACE " +// [^\n]*" "" text "${text}")
    string(REGEX REPLACE "\n\n+" "\n" text "${text}")
    string(HEX "${text}" hex)
  else()
    file(READ ${file} hex HEX)
  endif()
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(REPEAT "0x..," 20 line)
  string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
  # One zero more than the file has, so that an empty file is no empty array.
  string(APPEND arrays "constexpr unsigned char kBytes${number}[] = {\n${bytes}0};\n")
  string(APPEND rows "    {\"${name}\", kBytes${number}, sizeof kBytes${number} - 1},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "// Made by embed_page.cmake from server/http/page.
#include <array>

#include \"server/http/page_routes.h\"

namespace obliq::http {
namespace {

${arrays}
constexpr std::array<PageFile, ${number}> kFiles{{
${rows}}};

}  // namespace

std::span<const PageFile> page_files() { return kFiles; }

}  // namespace obliq::http
")
