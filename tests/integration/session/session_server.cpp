#include "tests/integration/session/session_server.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "server/security/security.h"
#include "tests/support/scenes.h"

namespace obliq::test {
namespace {

RadarConfig radar(const std::string& name) {
  RadarConfig config;
  config.name = name;
  RadarSettings& s = config.settings;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 60;
  s.r_min_m = 2000;
  s.r_max_m = 6000;
  s.pixel_columns = 64;
  s.pixel_rows = 48;
  s.azimuth_bins = 16;  // two wedges
  s.range_bins = 24;
  config.pose = settings_over_origin(1500, 40);
  return config;
}

/// A viewer, a controller, an admin.
std::shared_ptr<security::Security> three_roles() {
  const auto file =
      std::filesystem::temp_directory_path() / ("session_bytes_tokens." + std::to_string(getpid()));
  std::ofstream(file) << "viewer viewer-token-0123456789\ncontroller controller-token-0123456789\n"
                         "admin admin-token-0123456789\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  auto security = std::make_shared<security::Security>(security::SecurityFiles{file, "", ""});
  std::filesystem::remove(file);
  return security;
}

/// Before the frame's second wedge there is the gate.
class GatedFrame : public rendering::PlannedFrame {
 public:
  GatedFrame(std::unique_ptr<PlannedFrame> frame, Gate& gate) : frame_(std::move(frame)), gate_(gate) {}
  const PlannedFrame& behind() const { return *frame_; }

  void describe(const std::string& name, wire::FrameDescriptor& descriptor) const override {
    frame_->describe(name, descriptor);
  }
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    const int end = azimuths.first + azimuths.count;
    for (int first = azimuths.first; first < end; first += kWedgeAzimuthBins) {
      if (first == kWedgeAzimuthBins) gate_.pass();
      if (!frame_->render({first, std::min(kWedgeAzimuthBins, end - first)}, options)) return false;
    }
    return true;
  }
  void summarise(const FrameStats& stats, wire::FrameSummary& summary) const override {
    frame_->summarise(stats, summary);
  }
  AirView air() const override { return frame_->air(); }
  std::vector<wire::TargetRecord> truth(AzimuthRange azimuths, const RenderOptions& options,
                                        double noise_power_w) const override {
    return frame_->truth(azimuths, options, noise_power_w);
  }
  std::vector<std::uint32_t> seen() const override { return frame_->seen(); }
  void see_again(const std::vector<std::uint32_t>& buildings) const override { frame_->see_again(buildings); }
  std::unique_ptr<PlannedFrame> again(const PoseSettings& pose) const override {
    return std::make_unique<GatedFrame>(frame_->again(pose), gate_);
  }

 private:
  std::unique_ptr<PlannedFrame> frame_;
  Gate& gate_;
};

}  // namespace

rendering::FrameRenderer::Plan GatedRenderer::gated(Plan plan) const {
  if (plan.frame) plan.frame = std::make_unique<GatedFrame>(std::move(plan.frame), gate_);
  return plan;
}

rendering::FrameRenderer::Plan GatedRenderer::plan_again(const rendering::PlannedFrame& frame,
                                                         const SettingsPtr& settings,
                                                         const PoseSettings& pose) const {
  return gated(SceneRenderer::plan_again(dynamic_cast<const GatedFrame&>(frame).behind(), settings, pose));
}

std::shared_ptr<const Scene> session_scene() {
  WorldSpec spec = synthetic_spec(SyntheticKind::hills, 7000, 64);
  spec.terrain.shape.height_m = 500;
  spec.radius_factor = 4.0 / 3;
  spec.prisms.emplace_back();
  spec.prisms[0].per_km2 = 20;
  return make_scene(load_world(spec));
}

std::vector<RadarConfig> session_radars() {
  RadarConfig scanning = radar("scan");
  scanning.settings.scan_mode = ScanMode::sector;
  scanning.settings.scan_rate_deg_s = 20;
  return {radar("main"), scanning};
}

net::ServerOptions session_options() {
  net::ServerOptions options;
  options.port = 0;
  options.server_name = "recorded";
  options.server_version = "1";
  options.scene_name = "hills";
  options.security = three_roles();
  options.handshake_timeout_s = options.message_timeout_s = options.heartbeat_s = 600;
  options.stall_timeout_s = options.lossless_limit_s = 600;
  options.stop_limit_s = 60;
  options.stop_grace_s = 0.2;
  options.max_bins = 10000;
  options.max_memory_mb = std::numeric_limits<double>::infinity();  // 0: another on each machine
  options.max_renders_queued = options.max_subscriptions = 1;
  options.render_threads = 1;
  options.ground_at = [](const PoseSettings& pose, double) {
    return pose.latitude_deg < 33.01 ? GroundThere{} : GroundThere{0.25, "no file has ground there"};
  };
  options.query_ground = [scene = session_scene()](const GroundQuestion& question,
                                                   const std::stop_token& stop) {
    return answer_ground(scene, question, stop);
  };
  options.keeper_state = [] {
    KeeperState state;
    state.building = true;
    state.swaps = 2;
    state.failures = 1;
    state.last_error = state.last_failure = "no such file";
    state.well_s = 3;
    return state;
  };
  return options;
}

}  // namespace obliq::test
