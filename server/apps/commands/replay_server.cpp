#include "server/apps/commands/replay_server.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/replay/replay_renderer.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/serving.h"
#include "server/apps/version/version.h"
#include "server/control/key.h"
#include "server/control/parameter_reference.h"
#include "server/control/scene_file.h"
#include "server/control/settings_message.h"
#include "server/http/answering.h"
#include "server/http/page_routes.h"
#include "server/net/io_thread.h"
#include "server/net/requests/request_limits.h"
#include "server/net/server.h"
#include "server/websocket/upgrade.h"
#include "terrain/base/errors.h"
#include "terrain/base/memory_limit.h"

namespace obliq {
namespace {

// Between looks at whether it is over.
constexpr std::chrono::milliseconds kServingPause{50};

volatile std::sig_atomic_t g_hung_up = 0;
extern "C" void note_hang_up(int) { g_hung_up = 1; }

void say_warning(const std::string& note) { std::fprintf(stderr, "warning: %s\n", note.c_str()); }

/// What the short forms and --set say, on top of the file.
SceneConfig serving_config(const ServeArguments& arguments) {
  std::vector<std::string> flags = arguments.set;
  const auto add = [&](const std::string& key, const std::string& value) {
    flags.push_back(key + "=" + value);
  };
  if (arguments.address) {
    add("server.address", toml_string(*arguments.address));
    add("http.address", toml_string(*arguments.address));
  }
  if (arguments.port) add("server.port", std::to_string(*arguments.port));
  if (arguments.http_port) {
    add("http.enabled", "true");
    add("http.port", std::to_string(*arguments.http_port));
  }
  if (arguments.unprotected) add("server.unprotected", "true");
  if (arguments.max_memory_mb) add("server.max_memory_mb", toml_number(*arguments.max_memory_mb));
  return load_serving(arguments.config, {flags});
}

/// On ports of its own.
struct ServedRadar {
  std::string name;
  std::unique_ptr<net::Server> server;
  std::unique_ptr<http::HttpServer> browsers;
};

/// Of the radar of that number: one behind the other, unless any free one will do.
std::uint16_t port_of(int first, int number) {
  return static_cast<std::uint16_t>(first == 0 ? 0 : std::min(first + number, 65535));
}

net::ServerOptions options_of(const SceneConfig& config, int number,
                              const std::shared_ptr<security::Security>& security,
                              const client::RecordingStart& start) {
  net::ServerOptions options = serving_options(config);
  options.port = port_of(config.server.port, number);
  options.security = security;
  options.server_name = "obliq replay";
  options.server_version = program_version();
  options.scene_name = start.descriptor->scene_name();
  options.max_memory_mb = memory_limit_mb(options.max_memory_mb);
  return options;
}

/// The recorded radar, if it can be served.
RadarConfig servable_radar(const client::RecordingStart& start, const std::string& path,
                           const net::ServerOptions& options) {
  if (start.descriptor->has_window())
    throw InputError("--serve: found " + path +
                     ", of a part of the bins (--azimuths, --ranges); allowed: a recording of whole frames");
  RadarConfig radar;
  radar.name = start.radar;
  for (const auto& errors : {merge_message(start.descriptor->settings(), radar.settings),
                             merge_message(start.descriptor->pose(), radar.pose)}) {
    if (!errors.empty()) throw InputError(path + ": its radar: " + errors.front().text());
  }
  // Its beam has swept: the passes come out of the recording.
  radar.settings.scan_mode = ScanMode::frame;
  const rendering::FrameCost cost = net::replay_cost(radar.settings, start.planes, options);
  if (const auto over = net::over_memory(radar.settings, cost, 0, options))
    throw InputError(path + ": " + over->text + "; allowed: a larger --max-memory-mb, inf for no limit");
  return radar;
}

/// The page and the stream for browsers, beside `server` on its thread.
std::unique_ptr<http::HttpServer> serve_browsers(const SceneConfig& config, int number,
                                                 const std::shared_ptr<security::Security>& security,
                                                 net::IoThread& io, net::Server& server) {
  std::vector<http::Route> routes = http::page_routes(parameters_json());
  http::Readiness readiness;
  readiness.ready();
  routes.push_back({"/healthz", true, http::health_page});
  routes.push_back({"/readyz", true, [state = readiness.state()] { return http::readiness_page(state); }});
  routes.push_back(http::page_state_route([state = readiness.state()] { return http::readiness_page(state); },
                                          {config.http.range_scales, config.http.range_unit}));
  http::HttpOptions options = http_options(config, security);
  options.port = port_of(config.http.port, number);
  return std::make_unique<http::HttpServer>(
      io.context(), options, std::move(routes),
      websocket::upgrade(
          io.context(), [&server] { return &server; }, [] { return http::Page{}; }));
}

void read_security_again(std::vector<ServedRadar>& served, security::Security& security) {
  const security::Security::Reloaded reloaded = security.reload();
  for (ServedRadar& its : served) its.server->check_credentials();
  for (const std::string& fault : {reloaded.tokens_fault, reloaded.certificate_fault})
    if (!fault.empty()) say_warning(fault + "; the old content stays in force");
}

}  // namespace

void add_serve_arguments(CLI::App& command, CLI::Option* serve, ServeArguments& arguments) {
  command
      .add_option("--config", arguments.config,
                  "With --serve: scene file of obliqd, whose [server], [stream] and [http] hold (addresses, "
                  "TLS, tokens, limits); nothing else of it is read")
      ->needs(serve)
      ->type_name("SCENE");
  command
      .add_option("--set", arguments.set,
                  "With --serve: KEY=VALUE of these sections, as for obliqd, e.g. "
                  "server.tls_certificate=server.crt; beats file and environment (repeatable)")
      ->needs(serve)
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  const auto port = whole_number_from(0, std::numeric_limits<std::uint16_t>::max());
  command.add_option("--port", arguments.port, "Short for --set server.port; 0: any free one")
      ->needs(serve)
      ->type_name("N")
      ->check(port);
  command
      .add_option("--http-port", arguments.http_port,
                  "Short for --set http.enabled=true --set http.port: also the page and the stream for "
                  "browsers (/stream) over HTTP; 0: any free one")
      ->needs(serve)
      ->type_name("N")
      ->check(port);
  command
      .add_option("--address", arguments.address,
                  "Short for --set server.address and --set http.address: where to listen; default: loopback")
      ->needs(serve)
      ->type_name("HOST");
  command
      .add_flag("--unprotected", arguments.unprotected,
                "Short for --set server.unprotected=true: serve other machines without TLS and tokens")
      ->needs(serve);
  command
      .add_option("--max-memory-mb", arguments.max_memory_mb,
                  "Short for --set server.max_memory_mb: refuse what would take more memory than this with "
                  "what is in use; 0: three quarters of the machine's or of its control group's; inf: no "
                  "limit")
      ->needs(serve)
      ->type_name("MB")
      ->check(number_from(0, std::numeric_limits<double>::infinity()));
}

client::RecordingLosses serve_recording(const ServeArguments& arguments, const std::string& file,
                                        std::vector<client::RecordingStart> starts,
                                        const ReplayOptions& replay) {
  const SceneConfig config = serving_config(arguments);
  check_protection(config);
  const std::shared_ptr<security::Security> security = server_security(config.server);
  for (const std::string& warning : security->warnings()) say_warning(warning);
  for (const std::string& warning : address_warnings(config)) say_warning(warning);
  const int radars = static_cast<int>(starts.size());
  std::atomic<int> ended = 0;
  std::vector<std::unique_ptr<ReplayRenderer>> renderers;
  net::IoThread io;
  std::vector<ServedRadar> served;
  const std::shared_ptr<void> first_of_all(nullptr, [&io](void*) { io.end(); });
  ReplayOptions in_step = replay;
  if (radars > 1)
    in_step.origin_utc_ns = std::ranges::min_element(starts, {}, &client::RecordingStart::utc_ns)->utc_ns;
  for (client::RecordingStart& start : starts) {
    const int number = static_cast<int>(served.size());
    const net::ServerOptions options = options_of(config, number, security, start);
    const RadarConfig radar = servable_radar(start, file, options);
    renderers.push_back(std::make_unique<ReplayRenderer>(file, std::move(start), in_step, say_warning,
                                                         [&ended] { ++ended; }));
    for (int other = 0; other < number; ++other)
      renderers.back()->keep_in_step(*renderers[static_cast<std::size_t>(other)]);
    ServedRadar& its = served.emplace_back();
    its.name = radar.name;
    its.server =
        std::make_unique<net::Server>(io.context(), *renderers.back(), std::vector<RadarConfig>{radar},
                                      options, net::ReservedPort(options.address, options.port));
    if (config.http.enabled) its.browsers = serve_browsers(config, number, security, io, *its.server);
  }
  heed_interrupts();
  if (security->needs_token() || security->has_tls()) (void)std::signal(SIGHUP, note_hang_up);
  int stopped = 0;  // the io thread's
  for (ServedRadar& its : served)
    its.server->start([&] {
      if (++stopped < radars) return;
      for (ServedRadar& one : served)
        if (one.browsers) one.browsers->stop();
      io.release();
    });
  for (std::size_t k = 0; k < served.size(); ++k) {
    if (served[k].browsers) std::printf("the picture in a browser: %s\n", served[k].browsers->url().c_str());
    std::printf("ready: replays radar %s (%s) on %s\n", served[k].name.c_str(),
                wire::plane_names(renderers[k]->planes()).c_str(), served[k].server->address().c_str());
  }
  std::fflush(stdout);
  while (ended < radars && !interrupted()) {
    std::this_thread::sleep_for(kServingPause);
    if (std::exchange(g_hung_up, 0) != 0) read_security_again(served, *security);
  }
  if (ended < radars)
    for (const auto& renderer : renderers) renderer->stop();
  for (ServedRadar& its : served) its.server->stop();  // when clients have taken what waits for them
  io.join();
  client::RecordingLosses losses;
  for (const auto& renderer : renderers) losses = client::more_of(losses, renderer->losses());
  return losses;
}

}  // namespace obliq
