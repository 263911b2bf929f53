// `obliq status`: what a server is doing, and how each of its radars stands.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "server/control/quality_presets.h"
#include "server/output/describe_frame.h"

namespace obliq {
namespace {

struct StatusArguments {
  ServerArguments server;
  bool json = false;
};

/// "sweep, 2048 columns (standard)", "oblique, 4096 x 2048 pixels, spread plates".
std::string sampling_text(const wire::RadarSettings& settings) {
  const std::string kind = wire::enum_word(wire::FrustumKind_Name(settings.frustum()));
  const std::string plates = wire::enum_word(wire::PlateKind_Name(settings.plates()));
  const bool sweeps = settings.frustum() == wire::SWEEP;
  std::string text = fmt::format("{}, {}", kind, settings.pixel_columns());
  if (!sweeps) text += fmt::format(" x {}", settings.pixel_rows());
  text += sweeps ? " columns" : " pixels, " + plates + " plates";
  for (const QualityPreset& preset : quality_presets()) {
    if (preset.kind == kind && preset.columns_for(settings.azimuth_bins()) == settings.pixel_columns() &&
        (sweeps ||
         (preset.plates == plates && preset.rows_for(settings.range_bins()) == settings.pixel_rows())))
      return text + " (" + std::string(preset.name) + ")";
  }
  return text;
}

/// "dbs, 64 pulses at 2000 Hz", "sar, 3 m"; empty: a map.
std::string mode_text(const wire::RadarSettings& settings) {
  std::string mode = wire::enum_word(wire::RadarMode_Name(settings.mode()));
  mode.resize(std::min(mode.find("_mode"), mode.size()));
  switch (settings.mode()) {
    case wire::MTI_MODE:
      return fmt::format("{}, {} delay{} at {:g} Hz{}", mode, settings.canceller(),
                         settings.canceller() == 1 ? "" : "s", settings.prf_hz(),
                         settings.clutter_lock() ? ", clutter lock" : "");
    case wire::DBS_MODE:
    case wire::PULSES_MODE:
      return fmt::format("{}, {} pulses at {:g} Hz", mode, settings.doppler_pulses(), settings.prf_hz());
    case wire::SAR_MODE:
      return fmt::format("{}, {:g} m", mode, settings.resolution_m());
    default:
      return {};
  }
}

void print_server(const client::Client& client, const wire::Status& status) {
  std::printf("%s %s, scene %s, up %.0f s, %u client%s, %.1f MB sent, %" PRIu64
              " frames dropped, %u renders queued\n",
              status.server_name().c_str(), status.server_version().c_str(),
              client.welcome().scene_name().c_str(), status.uptime_s(), status.clients(),
              status.clients() == 1 ? "" : "s", static_cast<double>(status.bytes_sent()) * 1e-6,
              status.frames_dropped(), status.renders_queued());
  if (status.targets() > 0 || !status.targets_controller().empty()) {
    std::printf("targets: %u of at most %u, %s%s", status.targets(), status.max_targets(),
                status.targets_controller().empty() ? "not claimed" : "held by ",
                status.targets_controller().c_str());
    if (status.targets_expired() > 0)
      std::printf(", %" PRIu64 " went when their validity was over", status.targets_expired());
    if (status.targets_late() > 0) std::printf(", %" PRIu64 " updates came late", status.targets_late());
    std::printf("\n");
  }
  if (status.windows_loaded() == 0 && status.window_failures() == 0 && !status.window_loading()) return;
  std::printf("terrain: %" PRIu64 " loaded since the start, %" PRIu64 " could not be%s",
              status.windows_loaded(), status.window_failures(),
              status.window_loading() ? ", one is being loaded" : "");
  if (!status.window_error().empty()) {
    std::printf("; at present: %s", status.window_error().c_str());
  } else if (status.window_well_s() > 0) {
    std::printf("; well for %.0f s, before that: %s", status.window_well_s(),
                status.window_failure().c_str());
  }
  std::printf("\n");
}

void print_radar(const wire::RadarStatus& radar, const wire::RadarInfo& info) {
  std::printf("%s: settings %" PRIu64 ", %s, %u watching at %g Hz, %" PRIu64 " frames", radar.radar().c_str(),
              radar.settings_version(), holders_text(radar.controller(), radar.settings_controller()).c_str(),
              radar.subscribers(), radar.rate_hz(), radar.frames());
  if (radar.frames() > 0) std::printf(", the last in %.1f ms", 1000 * radar.last_render_s());
  if (radar.frames_shed() > 0) std::printf(", %" PRIu64 " shed for lack of time", radar.frames_shed());
  if (!radar.platform().empty()) std::printf(", rides on %s", radar.platform().c_str());
  if (radar.rate_limit_hz() > 0) std::printf(", at most %g Hz", radar.rate_limit_hz());
  if (radar.transmit_off()) std::printf(", transmit off");
  if (radar.frozen()) std::printf(", frozen");
  if (radar.pose_stale()) std::printf(", its pose is stale");
  if (!radar.gimbal().empty()) std::printf(", gimbal: %s", radar.gimbal().c_str());
  if (radar.late_poses() > 0) std::printf(", %" PRIu64 " poses came late", radar.late_poses());
  if (radar.dwells_missed() > 0) std::printf(", %" PRIu64 " dwells missed", radar.dwells_missed());
  if (!radar.fault().empty()) std::printf(", cannot be rendered: %s", radar.fault().c_str());
  const wire::RadarSettings& settings = info.settings();
  std::printf("\n  pose: %s\n", pose_text(info.pose()).c_str());
  std::printf("  ranges: %g to %g m, sector %g degrees, %d x %d bins, %g GHz", settings.r_min_m(),
              settings.r_max_m(), settings.sector_deg(), settings.azimuth_bins(), settings.range_bins(),
              settings.frequency_ghz());
  if (settings.scan_mode() != wire::FRAME_SCAN)
    std::printf(", scans %s at %g degrees/s",
                settings.scan_mode() == wire::SECTOR_SCAN ? "its sector" : "round",
                settings.scan_rate_deg_s());
  if (settings.scan_mode() != wire::FRAME_SCAN && settings.scan_bars().tilt_deg_size() > 0) {
    std::printf(", bars at");
    for (const double tilt_deg : settings.scan_bars().tilt_deg()) std::printf(" %g", tilt_deg);
    std::printf(" degrees");
  }
  if (const std::string mode = mode_text(settings); !mode.empty()) std::printf("\n  mode: %s", mode.c_str());
  std::printf("\n  sampling: %s\n", sampling_text(settings).c_str());
  if (radar.has_coverage())
    std::printf("  ground: under %.4g %% of the newest frame's sector%s%s\n", 100 * radar.coverage(),
                radar.coverage_reason().empty() ? "" : "; ", radar.coverage_reason().c_str());
}

void print_json(const client::Client& client, const wire::Status& status,
                const std::vector<wire::RadarInfo>& infos, const std::string& only) {
  using Json = nlohmann::ordered_json;
  Json root = Json::parse(wire::file_json(status));
  root.erase("request_id");
  root["scene_name"] = client.welcome().scene_name();
  Json radars = Json::array();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    Json radar = root["radars"][i];
    const Json info = Json::parse(wire::file_json(infos[i]));
    radar["pose"] = info["pose"];
    radar["settings"] = info["settings"];
    if (!status.radars(static_cast<int>(i)).has_coverage()) radar.erase("coverage");
    radar["sampling"] = sampling_text(infos[i].settings());
    if (only.empty() || infos[i].radar() == only) radars.push_back(std::move(radar));
  }
  root["radars"] = std::move(radars);
  std::printf("%s\n", root.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

void run(const StatusArguments& arguments) {
  client::Client client = connect_to_server(arguments.server, "obliq status");
  const std::string& only = arguments.server.radar;
  if (!only.empty()) (void)choose_remote_radar(client, arguments.server);
  wire::Status status;
  require(client.get_status(status));
  std::vector<wire::RadarInfo> infos(static_cast<std::size_t>(status.radars_size()));
  for (std::size_t i = 0; i < infos.size(); ++i)
    require(client.get_radar(status.radars(static_cast<int>(i)).radar(), infos[i]));
  if (arguments.json) return print_json(client, status, infos, only);
  print_server(client, status);
  for (std::size_t i = 0; i < infos.size(); ++i)
    if (only.empty() || infos[i].radar() == only) print_radar(status.radars(static_cast<int>(i)), infos[i]);
}

}  // namespace

void add_status(CLI::App& app) {
  CLI::App* command = app.add_subcommand("status", "Show the state of a server and of its radars");
  auto arguments = std::make_shared<StatusArguments>();
  add_server_arguments(*command, arguments->server, true);
  command->add_flag("--json", arguments->json, "Print everything that the server reports, as JSON");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
