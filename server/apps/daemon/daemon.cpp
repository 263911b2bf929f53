#include "server/apps/daemon/daemon.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio.hpp>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/daemon/reloader.h"
#include "server/apps/daemon/server_options.h"
#include "server/apps/daemon/service_manager.h"
#include "server/apps/serving.h"
#include "server/apps/version/version.h"
#include "server/control/parameter_reference.h"
#include "server/flight/scene_keeper.h"
#include "server/ground_query/ground_query.h"
#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/http/metrics.h"
#include "server/http/page_routes.h"
#include "server/loading/scene_loading.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/modbus/service.h"
#include "server/net/io_thread.h"
#include "server/net/server.h"
#include "server/net/tcp.h"
#include "server/rendering/frame_cache.h"
#include "server/rendering/scene_renderer.h"
#include "server/scene/scene_memory.h"
#include "server/security/security.h"
#include "server/websocket/upgrade.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Of a line in the log, which must not grow over its end.
std::string first_radar_names(const SceneConfig& config) {
  constexpr std::size_t kMost = 12;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMost, config.radars.size()); ++i)
    names += (names.empty() ? "" : ", ") + config.radars[i].name;
  if (config.radars.size() > kMost) names += " and " + std::to_string(config.radars.size() - kMost) + " more";
  return names;
}

/// Between the end of the service's own limit and the end of the process.
constexpr double kLastWords_s = 0.5;

namespace asio = boost::asio;

/// Fails at start-up, rather than on the first subscription, where a radar cannot be rendered as configured.
void check_radar(const rendering::FrameRenderer& renderer, const RadarConfig& radar,
                 const LoadReport& loaded) {
  const auto snapshot = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  const auto plan = renderer.plan(snapshot, radar.pose);
  if (!plan.frame) throw InputError("radar \"" + radar.name + "\": " + all_text(plan.errors));
  wire::FrameDescriptor descriptor;
  plan.frame->describe(radar.name, descriptor);
  for (const std::string& warning : descriptor.warnings()) {
    const bool said = std::ranges::find(loaded.warnings, warning) != loaded.warnings.end();
    if (!said) log_warning("radar {}: {}", radar.name, warning);
  }
}

/// One object, so that what the io thread uses outlives that thread however the daemon ends.
class Daemon {
 public:
  Daemon(SceneConfig config, SceneArguments arguments)
      : config_(std::move(config)), arguments_(std::move(arguments)), metrics_(build_info()) {
    on_log_line([this](const std::string& level) { metrics_.log_line(level); });
  }
  ~Daemon() {
    io_.end();
    on_log_line({});
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  void run();

 private:
  void heed_signals();
  void wait_for_signal();
  void on_signal();
  static void end_by(double limit_s);
  void keep_pulse();
  void open_http();
  void load();
  void serve(net::ReservedPort port, std::optional<net::ReservedPort> modbus_port);
  Progress progress();

  SceneConfig config_;
  SceneArguments arguments_;
  std::shared_ptr<security::Security> security_;
  http::Readiness readiness_;
  http::Metrics metrics_;
  net::IoThread io_;
  asio::signal_set signals_{io_.context()};
  asio::steady_timer pulse_{io_.context()};
  std::unique_ptr<http::HttpServer> http_;
  std::optional<Reloader> reloader_;  ///< the io thread's, once it heeds signals
  std::optional<rendering::SceneRenderer> renderer_;
  std::optional<rendering::FrameCache> cache_;
  std::unique_ptr<SceneKeeper> keeper_;  ///< exchanges the renderer's scene
  std::optional<net::Server> server_;
  net::Server* serving_ = nullptr;  ///< the io thread's: set when clients are served
};

void Daemon::run() {
  const ServerConfig& server = config_.server;
  check_protection(config_);
  security_ = server_security(server);
  for (const std::string& warning : security_->warnings()) log_warning("{}", warning);
  for (const std::string& warning : address_warnings(config_)) log_warning("{}", warning);
  net::ReservedPort port(server.address, static_cast<std::uint16_t>(server.port));
  auto modbus_port = modbus::reserve(config_.modbus);
  if (config_.http.enabled) open_http();
  reloader_.emplace(io_, security_, config_, arguments_);
  heed_signals();
  io_.post([this] { keep_pulse(); });
  load();
  serve(std::move(port), std::move(modbus_port));
  log_info("stopped");
}

void Daemon::heed_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) signals_.add(signal);
  wait_for_signal();
}

void Daemon::wait_for_signal() {
  signals_.async_wait([this](boost::system::error_code error, int signal) {
    if (error) return;
    if (signal != SIGHUP) return on_signal();
    reloader_->begin();
    wait_for_signal();
  });
}

// Work that cannot be interrupted (a wedge that takes minutes, Embree's build of a new scene) must not delay
// the end: by then every client has its last message, and nothing is left to save.
void Daemon::end_by(double limit_s) {
  std::thread([limit_s] {
    std::this_thread::sleep_for(from_seconds(limit_s));
    log_warning("stopped at server.stop_limit_s; unfinished work was dropped");
    _exit(0);
  }).detach();
}

void Daemon::on_signal() {
  if (serving_ == nullptr) {
    log_info("stopping while loading");
    _exit(0);  // no client is served yet, and loading cannot be interrupted
  }
  readiness_.stopping();
  service_manager::stopping();
  signals_.clear();  // a second Ctrl-C ends the process
  end_by(reloader_->in_file().server.stop_limit_s + kLastWords_s);
  server_->stop();
}

// From the io thread: when it hangs, systemd misses the pulse and restarts the daemon.
void Daemon::keep_pulse() {
  static constexpr std::chrono::microseconds kUsual = std::chrono::seconds(1);
  const auto watched = service_manager::watchdog_period();
  if (watched) service_manager::watchdog();
  report_suppressed_lines();
  pulse_.expires_after(watched ? std::min(*watched / 3, kUsual) : kUsual);
  pulse_.async_wait([this](boost::system::error_code error) {
    if (!error) keep_pulse();
  });
}

void Daemon::open_http() {
  const auto metrics = [this] {
    std::optional<net::RoomStatistics> room;
    if (serving_ != nullptr) room = serving_->statistics();
    http::SceneStatistics scene;
    if (serving_ != nullptr) {
      const SceneKeeper::State state = keeper_->state();
      scene = {state.swaps, state.failures, state.building, state.last_build_s,
               scene_memory(*renderer_->scene())};
    }
    return http::metrics_page(metrics_.text(room ? &*room : nullptr, scene, security_->certificate_end_s()));
  };
  std::vector<http::Route> routes = http::page_routes(parameters_json());
  routes.push_back({"/healthz", true, http::health_page});
  routes.push_back({"/readyz", true, [this] { return http::readiness_page(readiness_.state()); }});
  routes.push_back(http::page_state_route([this] { return http::readiness_page(readiness_.state()); },
                                          {config_.http.range_scales, config_.http.range_unit}));
  routes.push_back({"/metrics", false, metrics});
  http_ =
      std::make_unique<http::HttpServer>(io_.context(), http_options(config_, security_), std::move(routes),
                                         websocket::upgrade(
                                             io_.context(), [this] { return serving_; },
                                             [this] { return http::readiness_page(readiness_.state()); }));
  log_info("HTTP on {}: /, {}, /healthz, /readyz, /metrics", http_->address(), websocket::kPath);
}

/// A log line per stage and quarter; /readyz knows better.
Progress Daemon::progress() {
  struct Last {
    std::string stage;
    int quarter = 0;
  };
  return [this, last = std::make_shared<Last>()](std::string_view stage, double fraction) {
    readiness_.loading(std::string(stage), fraction);
    const int quarter = static_cast<int>(fraction * 4);
    if (stage == last->stage && quarter <= last->quarter) return;
    *last = {std::string(stage), quarter};
    log_info("{}: {} %", stage, 25 * quarter);
    service_manager::status(fmt::format("loading: {}, {} %", last->stage, 25 * quarter));
  };
}

void Daemon::load() {
  const auto begin = std::chrono::steady_clock::now();
  const auto say = [](const ReportLine& line) {
    log_line(line.warns ? LogLevel::warning : LogLevel::info, "{}", line.text);
  };
  const Progress tell = progress();
  for (const std::string& note : config_.notes) say(note);
  tell("terrain", 0);
  meet_accuracy(config_, say, tell);
  const auto first_scene = build_scene(config_, say, tell);
  for (RadarConfig& radar : config_.radars)
    find_pixels(first_scene, radar, {config_.server.max_pixels, config_.threads}, say, tell);
  renderer_.emplace(first_scene, config_.name, program_version());
  cache_.emplace(*renderer_);
  keeper_ = std::make_unique<SceneKeeper>(
      config_, renderer_->scene(),
      [this](const SceneConfig& config, const std::stop_token& stop) {
        auto scene = build_scene_behind(config, stop);
        if (renderer_->scene()->built_tracer() != nullptr) scene->tracer();  // not when a frame waits for it
        return scene;
      },
      [this](std::shared_ptr<const Scene> scene) {
        renderer_->replace(std::move(scene));
        cache_->forget();
      });
  for (const RadarConfig& radar : config_.radars) {
    check_radar(*renderer_, radar, renderer_->scene()->world().report);
    metrics_.add_radar(radar.name);
  }
  metrics_.scene_loaded(seconds_since(begin));
}

void Daemon::serve(net::ReservedPort port, std::optional<net::ReservedPort> modbus_port) {
  net::ServerOptions options = server_options(config_);
  options.security = security_;
  options.on_frame = [this](const std::string& radar, const rendering::RenderedFrame& frame) {
    metrics_.frame(radar, frame);
  };
  options.on_request_frame = [this](const rendering::RenderedRequest& frame) { metrics_.once_frame(frame); };
  options.keeper_state = [this] { return keeper_->state(); };
  options.ground_at = [this](const PoseSettings& pose, double r_max_m) {
    return keeper_->ground_at({pose.longitude_deg, pose.latitude_deg}, r_max_m);
  };
  options.query_ground = [this](const GroundQuestion& question, const std::stop_token& stop) {
    return answer_ground(renderer_->scene(), question, stop);
  };
  options.on_moved = [this](std::vector<RadarPlace> places) { keeper_->poses_changed(std::move(places)); };
  server_.emplace(io_.context(), *cache_, config_.radars, options, std::move(port));
  const modbus::Service modbus(config_.modbus, std::move(modbus_port), server_->panel());
  io_.post([this] {
    serving_ = &*server_;
    server_->start([this] {
      if (http_) http_->stop();
      pulse_.cancel();
      io_.release();
    });
    const std::string names = first_radar_names(config_);
    readiness_.ready();
    const std::string serving = "serving " + names + " on " + server_->address();
    service_manager::ready(serving);
    if (http_) log_info("the picture in a browser: {}", http_->url());
    log_info("ready: {} on {}", names, server_->address());
    reloader_->serve(*server_, *keeper_, serving);
  });
  io_.join();
}

extern "C" void end_before_start(int) {
  constexpr std::string_view kLine = "obliqd: stopping while loading\n";
  (void)!write(STDERR_FILENO, kLine.data(), kLine.size());  // a failure could be reported nowhere
  _exit(0);
}

}  // namespace

void heed_signals_before_start() {
  struct sigaction action {};
  action.sa_handler = end_before_start;
  sigemptyset(&action.sa_mask);
  (void)std::signal(SIGHUP, SIG_IGN);  // nothing to reload yet
  for (const int signal : {SIGINT, SIGTERM}) {
    if (sigaction(signal, &action, nullptr) != 0)
      log_warning("signal {} cannot be handled; only SIGKILL will end this process", signal);
  }
}

void run_daemon(SceneConfig config, SceneArguments arguments) {
  Daemon(std::move(config), std::move(arguments)).run();
}

}  // namespace obliq
