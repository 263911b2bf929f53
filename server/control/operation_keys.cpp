#include "server/control/operation_keys.h"

#include <array>

namespace obliq {
namespace {

// The lists follow their enumerations.
constexpr std::array kFormats{Choice{"text"}, Choice{"json"}};
constexpr std::array kLevels{Choice{"debug"}, Choice{"info"}, Choice{"warning"}, Choice{"error"}};

using Scene = SceneConfig;
const std::array kOperation{
    Entry<Scene>{{"http.enabled", "", {}, {}, "Answer /healthz, /readyz and /metrics over HTTP."},
                 [](Scene& c) -> Slot { return &c.http.enabled; }},
    Entry<Scene>{{"http.address", "", {}, {}, "Address for HTTP to bind to."},
                 [](Scene& c) -> Slot { return &c.http.address; }},
    Entry<Scene>{{"http.port", "", closed(0, 65535), {}, "TCP port for HTTP; 0: any free one."},
                 [](Scene& c) -> Slot { return &c.http.port; }},
    Entry<Scene>{{"http.max_connections", "", closed(1, 1000), {}, "Most HTTP connections at a time."},
                 [](Scene& c) -> Slot { return &c.http.max_connections; }},
    Entry<Scene>{{"http.max_connections_per_address",
                  "",
                  closed(1, 1000),
                  {},
                  "Most HTTP connections at a time from one IPv4 address or one IPv6 /64 network."},
                 [](Scene& c) -> Slot { return &c.http.max_connections_per_address; }},
    Entry<Scene>{
        {"http.timeout_s",
         "s",
         closed(0.01, 3600),
         {},
         "Timeout for a request's header to arrive, for a response to be read, and between two requests."},
        [](Scene& c) -> Slot { return &c.http.timeout_s; }},
    Entry<Scene>{{"log.format", "", {}, kFormats, "Log lines as text or as JSON objects."},
                 [](Scene& c) -> Slot { return &c.log.format; }},
    Entry<Scene>{{"log.level", "", {}, kLevels, "Lowest level that is logged."},
                 [](Scene& c) -> Slot { return &c.log.level; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> operation_entries() { return kOperation; }

}  // namespace obliq
