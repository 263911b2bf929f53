#include <algorithm>
#include <array>

#include "server/control/sections/section.h"
#include "server/control/sections/server.h"
#include "server/control/sections/special_values.h"

namespace obliq {
namespace {

using Http = RowsOf<Change::restart, &SceneConfig::http>;
constexpr std::array kRows{
    Http::row<&HttpConfig::enabled>("http.enabled",
                                    "Serve the page, /healthz, /readyz and /metrics over HTTP."),
    Http::row<&HttpConfig::address>("http.address", "Address for HTTP to bind to."),
    Http::row<&HttpConfig::port>("http.port", closed(0, 65535), "TCP port for HTTP; 0: any free one."),
    Http::row<&HttpConfig::max_connections>("http.max_connections", closed(1, 1000),
                                            "Most HTTP connections at a time."),
    Http::row<&HttpConfig::max_connections_per_address>(
        "http.max_connections_per_address", closed(1, 1000),
        "Most HTTP connections at a time from one IPv4 address or one IPv6 /64 network."),
    Http::row<&HttpConfig::timeout_s>(
        "http.timeout_s", "s", closed(0.01, 3600),
        "Timeout for a request's header to arrive, for a response to be read, and between two requests."),
};

using Texts = std::vector<std::string> HttpConfig::*;

template <Texts list>
void read_texts(const FoundKey& found, SceneConfig& config) {
  for (const ConfigNode* node : found.reader.texts(found.name)) {
    const auto& text = std::get<std::string>(node->value);
    const bool is_one_word =
        !text.empty() && std::ranges::all_of(text, [](char c) { return c > ' ' && c < '\x7f'; });
    const bool is_name = text.find_first_of("/:") == std::string::npos;
    const std::size_t mark = text.find("://");
    const bool is_origin = (text.starts_with("http://") || text.starts_with("https://")) &&
                           text.find('/', mark + 3) == std::string::npos && text.size() > mark + 3;
    if (is_one_word && (list == &HttpConfig::names ? is_name : is_origin)) {
      (config.http.*list).push_back(text);
    } else {
      found.reader.complain(*node, found.name, found.allowed);
    }
  }
}

template <Texts list>
std::string printed_texts(const SceneConfig& config, const SceneConfig&) {
  const auto& texts = config.http.*list;
  return texts.empty() ? "" : toml_list(texts, toml_string);
}

const std::array kSpecial{
    special<SceneConfig>("http.names", "", kAny, "a list of names without ports, such as \"radar.example\"",
                         "Names under which browsers reach this server, besides its addresses and localhost; "
                         "requests for another Host are refused.",
                         read_texts<&HttpConfig::names>, printed_texts<&HttpConfig::names>, "[]",
                         Change::restart),
    special<SceneConfig>("http.origins", "", kAny,
                         "a list of SCHEME://HOST or SCHEME://HOST:PORT, such as \"https://screens.example\"",
                         "Pages of other servers that may use this one; requests from other pages than the "
                         "server's own are refused.",
                         read_texts<&HttpConfig::origins>, printed_texts<&HttpConfig::origins>, "[]",
                         Change::restart),
};

}  // namespace

const Section kHttpSection{"http", {kRows, kSpecial}, nullptr, true};

}  // namespace obliq
