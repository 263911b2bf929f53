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
    Entry<Scene>{{"server.tokens",
                  "",
                  {},
                  {},
                  "File of tokens, one a line: ROLE TOKEN [NAME], mode 600; empty: everybody on this machine "
                  "may do everything."},
                 [](Scene& c) -> Slot { return &c.server.tokens; }},
    Entry<Scene>{{"server.tls_certificate",
                  "",
                  {},
                  {},
                  "PEM file with the certificate and its issuers; then the ports speak TLS only."},
                 [](Scene& c) -> Slot { return &c.server.tls_certificate; }},
    Entry<Scene>{{"server.tls_key", "", {}, {}, "PEM file with the private key of the certificate."},
                 [](Scene& c) -> Slot { return &c.server.tls_key; }},
    Entry<Scene>{{"server.unprotected",
                  "",
                  {},
                  {},
                  "Serve other machines without TLS and tokens: whoever reaches the port may do everything."},
                 [](Scene& c) -> Slot { return &c.server.unprotected; }},
    Entry<Scene>{{"server.max_clients", "", closed(1, 10000), {}, "Clients served at a time."},
                 [](Scene& c) -> Slot { return &c.server.max_clients; }},
    Entry<Scene>{{"server.max_clients_per_address",
                  "",
                  closed(1, 10000),
                  {},
                  "Clients served at a time from one IPv4 address, or one IPv6 /64 network."},
                 [](Scene& c) -> Slot { return &c.server.max_clients_per_address; }},
    Entry<Scene>{
        {"server.max_request_bytes", "", closed(1024, 64 << 20), {}, "Longest message a client may send."},
        [](Scene& c) -> Slot { return &c.server.max_request_bytes; }},
    Entry<Scene>{{"server.handshake_timeout_s",
                  "s",
                  closed(0.01, 3600),
                  {},
                  "A connection that has not said hello by then is closed."},
                 [](Scene& c) -> Slot { return &c.server.handshake_timeout_s; }},
    Entry<Scene>{{"server.message_timeout_s",
                  "s",
                  closed(0.01, 3600),
                  {},
                  "A message that has begun must be complete by then."},
                 [](Scene& c) -> Slot { return &c.server.message_timeout_s; }},
    Entry<Scene>{{"server.stall_timeout_s",
                  "s",
                  closed(0.01, 3600),
                  {},
                  "A client that reads nothing for so long is dropped."},
                 [](Scene& c) -> Slot { return &c.server.stall_timeout_s; }},
    Entry<Scene>{
        {"server.heartbeat_s", "s", closed(0.01, 3600), {}, "The server is never silent for longer."},
        [](Scene& c) -> Slot { return &c.server.heartbeat_s; }},
    Entry<Scene>{{"server.idle_timeout_s",
                  "s",
                  closed(0, 86400),
                  {},
                  "A client that says nothing for so long is closed; 0: never. The client library answers "
                  "heartbeats."},
                 [](Scene& c) -> Slot { return &c.server.idle_timeout_s; }},
    Entry<Scene>{{"server.dead_after_s",
                  "s",
                  closed(4, 86400),
                  {},
                  "A client whose machine gives no sign of life for so long is dropped."},
                 [](Scene& c) -> Slot { return &c.server.dead_after_s; }},
    Entry<Scene>{
        {"server.max_bins", "", closed(1, 8192.0 * 8192.0), {}, "Most bins a client may ask for in a frame."},
        [](Scene& c) -> Slot { return &c.server.max_bins; }},
    Entry<Scene>{{"server.stop_limit_s",
                  "s",
                  closed(0, 3600),
                  {},
                  "When stopping, begun frames and queues have so long; then they are cut."},
                 [](Scene& c) -> Slot { return &c.server.stop_limit_s; }},
    Entry<Scene>{{"server.queue_frames", "", closed(1, 1000), {}, "Frames that wait for a slow client."},
                 [](Scene& c) -> Slot { return &c.server.queue_frames; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> server_entries() { return kServer; }

}  // namespace obliq
