#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/control/mount.h"
#include "server/control/sections/radar.h"
#include "server/control/settings_message.h"
#include "server/net/claims.h"
#include "server/net/options.h"
#include "server/net/peer.h"
#include "server/rendering/demand.h"

namespace obliq::net {

/// A client that watches a radar.
struct Watcher {
  Peer* peer = nullptr;
  rendering::Demand demand;
  std::uint64_t accused_frame = 0;                  ///< the oldest frame when it was last found too slow
  std::chrono::steady_clock::time_point accused{};  ///< since when it has held that frame up
  bool window_lost = false;  ///< it has been told that its window lies outside the frame
};

/// What to switch; empty: leave it.
struct RadarSwitches {
  std::optional<bool> transmit;
  std::optional<bool> freeze;
};

struct LiveRadar;

/// What live radars ride on: one pose moves all of them. It is held as their poses are, all together.
struct Platform {
  std::string name;
  PoseSettings initial;  ///< as the scene file has it
  PoseSettings pose;     ///< the newest, as it was sent
  std::vector<LiveRadar*> radars;
};

/// A named radar that clients share.
struct LiveRadar {
  LiveRadar(const RadarConfig& config, std::uint32_t stream)
      : name(config.name),
        stream_id(stream),
        initial(config),
        settings(config.settings),
        pose(config.pose),
        poses(std::make_shared<PoseTimeLine>(config.pose)) {}

  const std::string name;
  const std::uint32_t stream_id;
  RadarConfig initial;  ///< as the scene file has it
  SettingsStore settings;
  PoseSettings pose;  ///< the newest, as it was sent
  std::shared_ptr<PoseTimeLine> poses;
  bool pose_has_sim_time = false;
  std::int64_t pose_received_ns = 0;
  Platform* platform = nullptr;  ///< that it rides on; null: none
  bool has_heading = false;      ///< poses say where the nose points; else the bearing is the heading
  Claims claims;
  std::vector<Watcher> watchers;
  double rate_hz = 0;                                 ///< the fastest watcher's
  std::vector<FieldError> faults;                     ///< why it cannot be rendered as it is
  std::chrono::steady_clock::time_point faults_told;  ///< when the watchers were last told
  SettingsPtr faults_settings;                        ///< and for which settings
  std::uint64_t frames = 0;
  double last_render_s = 0;
  std::uint64_t dwells_missed = 0;  ///< of a scanning antenna
  bool off_the_map = false;         ///< no file covers the place of its newest pose
  double coverage = 0;              ///< of the newest frame, as are the next two
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;

  // Switched by its controller or the operator (Radars::flip), and the operator's limit:
  bool transmit = true;      ///< off: it is not rendered
  bool frozen = false;       ///< the render thread keeps the view that it has
  double rate_limit_hz = 0;  ///< 0: none

  /// Forgets the heading that poses gave; a platform always has one.
  void forget_heading() { has_heading = platform != nullptr; }
  std::size_t number() const { return stream_id - 1; }  ///< of the render thread
  rendering::LiveView view() const {
    return {settings.current(), pose, pose_received_ns, poses, false, initial.mount};
  }
  /// Where it looks now, as its gimbal lets it.
  rendering::LiveView shown() const;
};

/// A radar's next frame is due and has been waiting for `held_up_s`, because as many frames as may be wait
/// for clients. Makes room at the least cost to the clients that watch:
/// 1. a frame that only waits behind others, nowhere begun and nowhere lossless, is left out;
/// 2. after abort_after_s the oldest frame that no lossless client needs is aborted where it has begun;
/// 3. a client that has held the oldest frame for stall_timeout_s, and a lossless one that has taken nothing
///    for lossless_limit_s, is disconnected with error 10.
/// On the io thread.
void relieve(LiveRadar& radar, const ServerOptions& options, double held_up_s);

}  // namespace obliq::net
