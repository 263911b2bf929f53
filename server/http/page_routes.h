#pragma once
// The page: the files of server/http/page, which are part of the program.
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_server.h"

namespace obliq::http {

struct PageFile {
  std::string_view name;  ///< "index.html"
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
};

std::span<const PageFile> page_files();

/// By the name's ending, as browsers want it; empty: the page has no files of that kind.
std::string_view media_type(std::string_view name);

/// "/" for index.html, "/NAME" for each file, "/help" as well for help.html, and "/parameters.json", which
/// says `parameters`. All open: they hold no secret.
std::vector<Route> page_routes(std::string parameters);

}  // namespace obliq::http
