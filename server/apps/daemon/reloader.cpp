#include "server/apps/daemon/reloader.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <filesystem>
#include <utility>

#include "server/apps/daemon/service_manager.h"
#include "server/control/parameters.h"
#include "server/control/scene_file.h"
#include "server/control/sections/platform.h"
#include "server/control/sections/section.h"
#include "server/control/sections/targets.h"
#include "server/flight/scene_keeper.h"
#include "server/loading/scene_loading.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/panel.h"
#include "server/net/server.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/security/security.h"
#include "terrain/base/errors.h"

namespace obliq {

namespace {

/// Complaints of a line each in one line.
std::string joined(const std::string& text) {
  std::string line;
  for (const char c : text) line += c == '\n' ? "; " : std::string(1, c);
  return line;
}

/// In brackets, what a reload that has failed has done all the same.
std::string but(const std::string& taken) { return taken.empty() ? "" : " (" + taken + ")"; }

/// The configuration with nothing in it but what a scene is built from, as text. Of the radars that is how
/// far they look, for so much ground is loaded.
std::string scene_text(SceneConfig config) {
  const SceneConfig defaults;
  config.server = defaults.server;
  config.stream = defaults.stream;
  config.http = defaults.http;
  config.log = defaults.log;
  config.modbus = defaults.modbus;
  config.threads = defaults.threads;
  config.platforms.clear();
  for (RadarConfig& radar : config.radars) {
    RadarConfig kept;
    kept.name = radar.name;
    kept.settings.r_max_m = radar.settings.r_max_m;
    radar = kept;
  }
  return print_config(config);
}

/// What the file says now, but for what rides on what, which changes by a restart alone.
RadarConfig as_it_rides(RadarConfig wanted, const RadarConfig& known) {
  if ((wanted.platform == nullptr) != (known.platform == nullptr)) {
    const PoseSettings aim = wanted.pose;
    wanted.pose = known.pose;
    wanted.pose.tilt_deg = aim.tilt_deg;
    wanted.pose.tilt_auto = aim.tilt_auto;
  }
  wanted.platform = known.platform;
  wanted.mount = known.mount;
  return wanted;
}

bool same_pattern_file(const RadarSettings& known, const RadarSettings& wanted) {
  const PatternCuts* before = known.beam.file.get();
  const PatternCuts* now = wanted.beam.file.get();
  return before == now || (before != nullptr && now != nullptr && *before == *now);
}

}  // namespace

/// One thread for the small files, one for the scene file, whose elevation models may have to be opened, and
/// whose [accuracy] may have to be measured.
struct Reloader::Readers {
  boost::asio::thread_pool security{1};
  boost::asio::thread_pool scene{1};
};

Reloader::Reloader(net::IoThread& io, std::shared_ptr<security::Security> security, SceneConfig config,
                   SceneArguments arguments)
    : io_(io),
      security_(std::move(security)),
      arguments_(std::move(arguments)),
      at_start_(std::move(config)),
      in_file_(at_start_),
      signature_(scene_signature(at_start_)),
      readers_(std::make_unique<Readers>()) {}

Reloader::~Reloader() {
  ++newest_;  // ends what can be ended
  for (auto* reader : {&readers_->security, &readers_->scene}) {
    reader->stop();
    reader->join();
  }
}

void Reloader::serve(net::Server& server, SceneKeeper& keeper, std::string text) {
  server_ = &server;
  keeper_ = &keeper;
  serving_text_ = std::move(text);
  if (std::exchange(wanted_, false)) begin();
}

void Reloader::begin() {
  log_info("reloading {}", arguments_.file);
  const int number = ++newest_;
  reading_ = true;
  wanted_ = server_ == nullptr;
  if (!wanted_) service_manager::reloading();
  boost::asio::post(readers_->security, [this, number, server = server_] { read_security(number, server); });
}

void Reloader::read_security(int number, net::Server* server) {
  const security::Security::Reloaded reloaded =
      server == nullptr ? security_->reload() : server->reload_security();
  std::vector<std::string> faults;
  for (const std::string& fault : {reloaded.tokens_fault, reloaded.certificate_fault})
    if (!fault.empty()) faults.push_back(joined(fault));
  const bool tokens = security_->needs_token() && reloaded.tokens_fault.empty();
  const bool certificate = security_->has_tls() && reloaded.certificate_fault.empty();
  const std::string taken = tokens && certificate ? "tokens and certificate were taken over"
                            : tokens              ? "tokens were taken over"
                            : certificate         ? "the certificate was taken over"
                                                  : "";
  io_.post([this, number, taken, faults] { security_was_read(number, taken, faults); });
}

void Reloader::security_was_read(int number, const std::string& taken,
                                 const std::vector<std::string>& faults) {
  for (const std::string& fault : faults)
    log_error("reload: {}; the old one stays in effect; fix it and send SIGHUP again", fault);
  for (const std::string& warning : security_->warnings()) log_warning("{}", warning);
  if (!taken.empty()) log_info("reload: {}", taken);
  if (server_ != nullptr && number == newest_)
    boost::asio::post(readers_->scene, [this, number, taken] { read_scene(number, taken); });
}

// An elevation model may have to be opened, and [accuracy] measured.
void Reloader::read_scene(int number, const std::string& taken) {
  const auto go_on = [this, number] {
    if (number != newest_) throw InputError("a newer SIGHUP has come");
  };
  Read read;
  try {
    go_on();
    read.wanted = load_scene_file(arguments_.file, {arguments_.set});
    read.to_build = read.wanted;
    const auto say = [](const ReportLine& line) { log_info("{}", line.text); };
    meet_accuracy(read.to_build, say, [&](std::string_view, double) { go_on(); });
    go_on();
  } catch (const std::exception& e) {
    read.fault = joined(failure_text(e));
  }
  io_.post([this, number, taken, read = std::move(read)] { take_over(number, taken, read); });
}

void Reloader::take_over(int number, const std::string& taken, Read read) {
  if (number != newest_) return;  // the newer one tells its own story
  reading_ = false;
  if (!read.fault.empty()) {
    log_error("reload refused; scene, radars and limits are unchanged{}: {}; fix it and send SIGHUP again",
              but(taken), read.fault);
    return rest();
  }
  for (const std::string& key : keys_for_restart(at_start_, read.wanted))
    log_warning("reload: {} differs from what runs; restart obliqd to apply it", key);
  open_log(read.wanted.log);
  server_->set_limits(read.wanted.server);
  take_over_radars(read.wanted, read.to_build);
  const std::string signature = scene_signature(read.wanted);
  if (building_ && building_->signature == signature) {
    log_info("reloaded: the scene of this file is being built already");
  } else if (signature == signature_) {
    if (std::exchange(building_, std::nullopt)) keeper_->give_up_reload();
    log_info("reloaded: the scene is the same");
  } else {
    build(number, taken, signature, std::move(read.to_build));
  }
  rest();
}

// What a client has set since stays, unless its text in the file has changed.
void Reloader::take_over_radars(const SceneConfig& wanted, const SceneConfig& to_build) {
  std::vector<RadarConfig> radars = in_file_.radars;
  for (std::size_t i = 0; i < wanted.radars.size(); ++i) {
    const auto known = std::ranges::find(radars, wanted.radars[i].name, &RadarConfig::name);
    if (known == radars.end()) continue;  // needs a restart, which was said
    RadarConfig initial = to_build.radars[i];
    initial.mount = known->mount;  // a change of platforms needs a restart, which was said
    server_->panel().set_initial(known->name, initial);
    net::PanelChange change;
    std::string text;
    const RadarSettings& of_file_now = wanted.radars[i].settings;
    const bool by_planes = of_file_now.frustum == FrustumKind::sweep && of_file_now.planes_per_bin > 0;
    for (const Parameter& parameter : parameters()) {
      if (by_planes && parameter.key.name == "frustum.pixel_columns") continue;  // they follow
      if (is_of_platform(*known, parameter) || is_of_platform(wanted.radars[i], parameter)) continue;
      if (value_of(parameter, *known) == value_of(parameter, wanted.radars[i])) continue;
      change.settings.push_back({&parameter, value_of(parameter, to_build.radars[i])});
      text += (text.empty() ? "" : ", ") + std::string(parameter.key.name) + " is now " +
              toml_text(change.settings.back().value);
    }
    if (!same_pattern_file(known->settings, of_file_now)) {
      change.pattern_file = of_file_now.beam.file;
      text += (text.empty() ? "" : ", ") + std::string("beam.file is as in the file");
    }
    if (change.settings.empty() && !change.pattern_file) continue;
    const net::PanelAnswer answer = server_->panel().apply(known->name, change);
    if (answer.verdict == net::PanelVerdict::done) {
      log_info("radar {}: {}", known->name, text);
      *known = as_it_rides(wanted.radars[i], *known);
    } else if (answer.verdict == net::PanelVerdict::controlled) {
      log_warning("radar {}: {}; it keeps its own and takes \"{}\" at a SIGHUP while no client holds them",
                  known->name, answer.held, text);
    } else {
      log_error("radar {}: not applied: {}: {}; fix it and send SIGHUP again", known->name, text,
                all_text(answer.errors));
    }
  }
  in_file_ = wanted;
  in_file_.radars = std::move(radars);
}

void Reloader::build(int number, const std::string& taken, const std::string& signature, SceneConfig config) {
  building_ = Building{number, taken, signature};
  if (radar_names(at_start_) != radar_names(config)) config.radars = in_file_.radars;
  keeper_->reload(std::move(config), [this, number](const std::string& fault) {
    io_.post([this, number, fault] { built(number, fault); });
  });
}

void Reloader::built(int number, const std::string& fault) {
  if (!building_ || building_->number != number) return;  // superseded
  const Building done = *std::exchange(building_, std::nullopt);
  if (fault.empty()) {
    signature_ = done.signature;
    log_info("reloaded: serving the new scene");
  } else {
    log_error("reload failed; still serving the previous scene{}: {}; fix it and send SIGHUP again",
              but(done.taken), joined(fault));
  }
  rest();
}

void Reloader::rest() {
  if (!reading_ && !building_) service_manager::ready(serving_text_);
}

std::string radar_names(const SceneConfig& config) {
  std::string all;
  for (const RadarConfig& radar : config.radars) all += (all.empty() ? "" : ", ") + radar.name;
  return all;
}

/// The platforms, and what rides on them where.
std::string riders_text(const SceneConfig& config) {
  std::string text = printed_platforms(config);
  for (const RadarConfig& radar : config.radars) {
    const Mount& m = radar.mount;
    if (radar.platform)
      text += fmt::format("{} on {}: {} {} {} {} {} {} {} {}\n", radar.name, radar.platform->name,
                          m.forward_m, m.right_m, m.up_m, m.look_deg, m.gimbal.azimuth_min_deg,
                          m.gimbal.azimuth_max_deg, m.gimbal.elevation_min_deg, m.gimbal.elevation_max_deg);
  }
  return text;
}

std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted) {
  std::vector<std::string> keys;
  SceneConfig one = running;
  SceneConfig other = wanted;
  for (const auto& [key, slot, change] : scene_rows())
    if (change == Change::restart && load(key, slot(one)) != load(key, slot(other)))
      keys.emplace_back(key.name);
  if (running.modbus.allow != wanted.modbus.allow) keys.emplace_back("modbus.allow");
  if (radar_names(running) != radar_names(wanted))
    keys.push_back(
        fmt::format("the radars (running: {}; wanted: {})", radar_names(running), radar_names(wanted)));
  if (printed_targets(running) != printed_targets(wanted))
    keys.emplace_back("[target_types.NAME] or [[target]]");
  if (riders_text(running) != riders_text(wanted)) keys.emplace_back("[[platform]] or what rides on it");
  return keys;
}

std::string scene_signature(const SceneConfig& config) {
  std::string text = scene_text(config);
  const auto add = [&](const std::string& path) {
    std::error_code absent;  // a URL, or a file that is on its way: then the name alone counts
    const auto size = std::filesystem::file_size(path, absent);
    const auto time = std::filesystem::last_write_time(path, absent);
    if (!absent) text += fmt::format("{} {} {}\n", path, size, time.time_since_epoch().count());
  };
  for (const std::string& path : config.world.terrain.dem) add(path);
  for (const BuildingSourceSpec& spec : config.world.buildings) add(spec.source);
  for (const PrismSpec& spec : config.world.prisms) add(spec.within);
  for (const SurfaceSpec& spec : config.world.surfaces) add(spec.source);
  return text;
}

}  // namespace obliq
