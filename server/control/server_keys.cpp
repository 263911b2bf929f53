#include "server/control/server_keys.h"

#include <array>

namespace obliq {
namespace {

using Scene = SceneConfig;
const std::array kServer{
    Entry<Scene>{{"server.address", "", {}, {}, "Address that the daemon binds to."},
                 [](Scene& c) -> Slot { return &c.server.address; }},
    Entry<Scene>{{"server.port", "", closed(0, 65535), {}, "TCP port; 0: any free one."},
                 [](Scene& c) -> Slot { return &c.server.port; }},
    Entry<Scene>{{"server.max_clients", "", closed(1, 10000), {}, "Clients served at a time."},
                 [](Scene& c) -> Slot { return &c.server.max_clients; }},
    Entry<Scene>{
        {"server.max_request_bytes", "", closed(1024, 64 << 20), {}, "Longest message a client may send."},
        [](Scene& c) -> Slot { return &c.server.max_request_bytes; }},
    Entry<Scene>{{"server.handshake_timeout_s",
                  "s",
                  closed(0.01, 3600),
                  {},
                  "A connection that has not said hello by then is closed."},
                 [](Scene& c) -> Slot { return &c.server.handshake_timeout_s; }},
    Entry<Scene>{
        {"server.max_bins", "", closed(1, 8192.0 * 8192.0), {}, "Most bins a client may ask for in a frame."},
        [](Scene& c) -> Slot { return &c.server.max_bins; }},
    Entry<Scene>{{"server.queue_frames", "", closed(1, 1000), {}, "Frames that wait for a slow client."},
                 [](Scene& c) -> Slot { return &c.server.queue_frames; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> server_entries() { return kServer; }

}  // namespace obliq
