#include "server/control/sections/server.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "server/control/sections/section.h"
#include "server/control/sections/special_values.h"

namespace obliq {
namespace {

// --- [server] ---

using Server = RowsOf<Change::restart, &SceneConfig::server>;
using Limit = RowsOf<Change::reload, &SceneConfig::server>;
constexpr std::array kRoles{Choice{"viewer"}, Choice{"controller"}, Choice{"admin"}};
constexpr std::array kRowsOfServer{
    Server::row<&ServerConfig::address>("server.address", "Address to bind to."),
    Server::row<&ServerConfig::port>("server.port", closed(0, 65535), "TCP port; 0: any free one."),
    Server::row<&ServerConfig::tokens>(
        "server.tokens",
        "File of tokens, mode 600, one per line: ROLE TOKEN [NAME]; empty: any client on this "
        "machine may do everything."),
    Server::row<&ServerConfig::tls_certificate>(
        "server.tls_certificate",
        "PEM file with the certificate and its issuers; with it, all ports speak TLS only."),
    Server::row<&ServerConfig::tls_key>("server.tls_key", "PEM file with the certificate's private key."),
    Server::row<&ServerConfig::unprotected>(
        "server.unprotected",
        "Serve other machines without TLS and tokens: any client that reaches the port may do everything."),
    Limit::row<&ServerLimits::max_clients>("server.max_clients", closed(1, 10000), "Most clients at a time."),
    Limit::row<&ServerLimits::max_clients_per_address>(
        "server.max_clients_per_address", closed(1, 10000),
        "Most clients at a time from one IPv4 address or one IPv6 /64 network."),
    Limit::row<&ServerLimits::max_waiting>(
        "server.max_waiting", closed(1, 10000),
        "Most connections that have not yet sent Hello with a valid token, besides the clients; "
        "one more closes the oldest from the address that has the most."),
    Limit::row<&ServerLimits::max_request_bytes>("server.max_request_bytes", closed(1024, 64 << 20),
                                                 "Longest message that a client may send."),
    Limit::row<&ServerLimits::handshake_timeout_s>("server.handshake_timeout_s", "s", closed(0.01, 3600),
                                                   "A connection that has not sent Hello by then is closed."),
    Limit::row<&ServerLimits::message_timeout_s>(
        "server.message_timeout_s", "s", closed(0.01, 3600),
        "Time for a message to arrive completely once it has begun."),
    Limit::row<&ServerLimits::stall_timeout_s>("server.stall_timeout_s", "s", closed(0.01, 3600),
                                               "A client that reads nothing for this long is dropped."),
    Limit::row<&ServerLimits::heartbeat_s>("server.heartbeat_s", "s", closed(0.01, 3600),
                                           "The server sends something at least this often."),
    Limit::row<&ServerLimits::idle_timeout_s>(
        "server.idle_timeout_s", "s", closed(0, 86400),
        "A client that sends nothing for this long is dropped; 0: never. The client library "
        "answers heartbeats."),
    Server::row<&ServerConfig::dead_after_s>(
        "server.dead_after_s", "s", closed(4, 3600),
        "A client whose machine does not respond for this long is dropped."),
    Limit::row<&ServerLimits::max_bins>("server.max_bins", closed(1, 8192.0 * 8192.0),
                                        "Most bins per frame that a client may ask for."),
    Limit::row<&ServerLimits::stop_limit_s>(
        "server.stop_limit_s", "s", closed(0, 3600),
        "At shutdown, frames in progress and queues get this long to finish; then they are cut off."),
    Limit::row<&ServerLimits::max_pixels>(
        "server.max_pixels", closed(1, 16384.0 * 16384.0),
        "Most pixels per frame that a client may ask for; for the sweep, planes times range bins."),
    Limit::row<&ServerLimits::max_work_queued>(
        "server.max_work_queued", closed(1, 1e15),
        "Most pixels and bins in the unfinished RenderOnce requests of all clients together."),
    Limit::row<&ServerLimits::max_plan_taps>("server.max_plan_taps", closed(1, 1e12),
                                             "Most weights that an azimuth of a frame behind a beam takes, "
                                             "however high the antenna: sharp azimuths "
                                             "that the beam reaches, times tiles of 16 sharp ranges."),
    Limit::row<&ServerLimits::max_memory_mb>(
        "server.max_memory_mb", "MB", from(0),
        "A request is refused if the memory in use, the scene's included, plus the request's estimated need "
        "exceeds this; 0: three quarters of the memory of the machine or of the process's control group, "
        "whichever is less; inf: no limit, which 0 meant formerly."),
    Server::row<&ServerConfig::max_radars>("server.max_radars", closed(1, 256),
                                           "Most radars in a scene file."),
    Limit::row<&ServerLimits::max_renders_queued>("server.max_renders_queued", closed(1, 1000),
                                                  "Most unfinished RenderOnce requests per client."),
    Limit::row<&ServerLimits::max_subscriptions>("server.max_subscriptions", closed(1, 1000),
                                                 "Most radars that one client may watch."),
    Limit::row<&ServerLimits::max_targets>("server.max_targets", closed(0, 10000),
                                           "Most targets in the world, and in one RenderOnce."),
    Server::row<&ServerConfig::truth_role>(
        "server.truth_role", kRoles,
        "Role that a token must give for its client to be told where targets are: truth beside frames, the "
        "list of targets, targets in a saved exercise."),
    Limit::row<&ServerLimits::queue_frames>("server.queue_frames", closed(1, 1000),
                                            "Most frames that wait for a slow client."),
};

void resolve_paths(SceneReading& scene, SectionReader& reader) {
  ServerConfig& server = scene.config.server;
  const std::pair<const char*, std::string*> paths[] = {
      {"tokens", &server.tokens}, {"tls_certificate", &server.tls_certificate}, {"tls_key", &server.tls_key}};
  for (const auto& [name, path] : paths) {
    const ConfigNode* node = reader.table().find(name);
    if (node != nullptr && !path->empty()) *path = resolved_path(*node, scene.folder);
  }
}

// --- [http] ---

using Http = RowsOf<Change::restart, &SceneConfig::http>;
constexpr std::array kRowsOfHttp{
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

constexpr std::array kRangeUnits{Choice{"NM"}, Choice{"km"}};
constexpr std::size_t kMostScales = 16;

void read_scales(const FoundKey& found, SceneConfig& config) {
  const std::vector<double> scales = found.reader.numbers(found.name, found.key.limits, 1, kMostScales);
  if (scales.empty()) return;  // refused
  if (std::ranges::adjacent_find(scales, std::greater_equal{}) != scales.end()) return found.refuse();
  config.http.range_scales = scales;
}

void read_range_unit(const FoundKey& found, SceneConfig& config) {
  const std::string* text = found.text();
  const bool known =
      text != nullptr && std::ranges::find(kRangeUnits, *text, &Choice::name) != kRangeUnits.end();
  if (!known) return found.refuse();
  config.http.range_unit = *text;
}

const std::array kSpecialOfHttp{
    special<SceneConfig>(
        "http.range_scales", "", above(0, 500), "a list of 1 to 16 numbers that rise, each",
        "Range scales that the page offers, in http.range_unit; a ship's are 0.25, 0.5, 0.75, 1.5, 3, 6, 12, "
        "24, "
        "48, 96.",
        read_scales,
        [](const SceneConfig& config, const SceneConfig&) {
          return toml_list(config.http.range_scales, toml_number);
        },
        "[10.0, 20.0, 40.0, 80.0]", Change::restart),
    special<SceneConfig>(
        "http.range_unit", "", kRangeUnits, "", "Unit of http.range_scales, and of ranges on the page.",
        read_range_unit,
        [](const SceneConfig& config, const SceneConfig&) { return toml_string(config.http.range_unit); },
        "\"NM\"", Change::restart),
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

// --- [stream] ---

using Stream = RowsOf<Change::restart, &SceneConfig::stream>;
constexpr std::array kRowsOfStream{
    Stream::row<&StreamConfig::live_frames>(
        "stream.live_frames", closed(1, 100),
        "Most frames of one radar in memory at a time; the next waits until all clients have "
        "finished with one."),
    Stream::row<&StreamConfig::abort_after_s>(
        "stream.abort_after_s", "s", closed(0, 3600),
        "When a radar has waited this long, its oldest frame is aborted for the clients that still "
        "hold it."),
    Stream::row<&StreamConfig::lossless_limit_s>(
        "stream.lossless_limit_s", "s", closed(0.01, 3600),
        "A lossless client that holds up its radar and takes nothing for this long is dropped."),
};

// --- [flight] ---

using Flight = RowsOf<Change::reload, &SceneConfig::flight>;
constexpr std::array kRowsOfFlight{
    Flight::row<&FlightConfig::enabled>(
        "flight.enabled", "Load more terrain in the background when radars fly out of what is loaded."),
    Flight::row<&FlightConfig::reorigin_km>(
        "flight.reorigin_km", "km", closed(1, 100),
        "When the first radar is further than this from the scene's origin, the origin moves to it."),
    Flight::row<&FlightConfig::max_reach_km>(
        "flight.max_reach_km", "km", closed(0, 500),
        "Terrain is loaded for ranges up to this, whatever a client sets; 0: the longest r_max_m "
        "in the scene file."),
    Flight::row<&FlightConfig::max_megaposts>(
        "flight.max_megaposts", "million", above(0, 268),
        "Most posts of terrain to load while serving; they take 32 MB of memory per million, or 5 "
        "MB where every frustum is a sweep."),
};

// --- [log] ---

// The lists follow their enumerations.
constexpr std::array kFormats{Choice{"text"}, Choice{"json"}};
constexpr std::array kLevels{Choice{"debug"}, Choice{"info"}, Choice{"warning"}, Choice{"error"}};

using Log = RowsOf<Change::reload, &SceneConfig::log>;
constexpr std::array kRowsOfLog{
    Log::row<&LogConfig::format>("log.format", kFormats, "Log lines as text or as JSON objects."),
    Log::row<&LogConfig::level>("log.level", kLevels, "Lowest level that is logged."),
};

}  // namespace

const Section kServerSection{"server", {kRowsOfServer}, resolve_paths, true};
const Section kHttpSection{"http", {kRowsOfHttp, kSpecialOfHttp}, nullptr, true};
const Section kStreamSection{"stream", {kRowsOfStream}, nullptr, true};
const Section kFlightSection{"flight", {kRowsOfFlight}, nullptr, true};
const Section kLogSection{"log", {kRowsOfLog}, nullptr, true};

}  // namespace obliq
