#include <array>

#include "server/control/sections/section.h"
#include "server/control/sections/server.h"

namespace obliq {
namespace {

using Http = RowsOf<Change::restart, &SceneConfig::http>;
constexpr std::array kRows{
    Http::row<&HttpConfig::enabled>("http.enabled", "Answer /healthz, /readyz and /metrics over HTTP."),
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

}  // namespace

const Section kHttpSection{"http", {kRows}, nullptr, true};

}  // namespace obliq
