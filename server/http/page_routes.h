#pragma once
// The page: the files of server/http/page, which are part of the program.
#include <cstddef>
#include <functional>
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

/// What the page's range buttons offer.
struct RangeScales {
  std::vector<double> scales;
  std::string unit;  ///< "NM" or "km"
};

/// "/page.json", which the page asks for before it connects: what /readyz says as `state`, `range_scales` and
/// `range_unit`. Always answered by 200: a browser's console has a line for each 503.
Route page_state_route(std::function<Page()> readiness, const RangeScales& offered);

/// "/" for index.html, "/NAME" for each file, "/help" as well for help.html, and "/parameters.json", which
/// says `parameters`. All open: they hold no secret.
std::vector<Route> page_routes(std::string parameters);

}  // namespace obliq::http
