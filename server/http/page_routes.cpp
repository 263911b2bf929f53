#include "server/http/page_routes.h"

#include <array>
#include <charconv>
#include <memory>
#include <utility>

namespace obliq::http {
namespace {

constexpr std::string_view kStart = "index.html";
constexpr std::string_view kHtml = ".html";

std::string text_of(const PageFile& file) { return {reinterpret_cast<const char*>(file.bytes), file.size}; }

}  // namespace

// The WHATWG's MIME Sniffing standard, section 3; modules run only with a JavaScript type.
std::string_view media_type(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kTypes{{
      {kHtml, "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
  }};
  for (const auto& [ending, type] : kTypes)
    if (name.ends_with(ending)) return type;
  return {};
}

Route page_state_route(std::function<Page()> readiness, const RangeScales& offered) {
  std::string list;
  for (const double scale : offered.scales) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.begin(), digits.end(), scale).ptr;
    list += (list.empty() ? "" : ",") + std::string(digits.begin(), end);
  }
  const std::string rest = ",\"range_scales\":[" + list + "],\"range_unit\":\"" + offered.unit + "\"}";
  return {"/page.json", true, [readiness = std::move(readiness), rest] {
            std::string state;
            for (const char c : readiness().body) {
              if (static_cast<unsigned char>(c) < ' ') continue;
              if (c == '"' || c == '\\') state += '\\';
              state += c;
            }
            return Page{200, "application/json", "{\"state\":\"" + state + "\"" + rest};
          }};
}

std::vector<Route> page_routes(std::string parameters) {
  std::vector<Route> routes;
  for (const PageFile& file : page_files()) {
    const auto page = [&file] { return Page{200, std::string(media_type(file.name)), text_of(file)}; };
    const std::string path = "/" + std::string(file.name);
    routes.push_back({path, true, page});
    if (file.name == kStart)
      routes.push_back({"/", true, page});
    else if (path.ends_with(kHtml))
      routes.push_back({path.substr(0, path.size() - kHtml.size()), true, page});
  }
  routes.push_back(
      {"/parameters.json", true, [text = std::make_shared<const std::string>(std::move(parameters))] {
         return Page{200, "application/json", *text};
       }});
  return routes;
}

}  // namespace obliq::http
