#pragma once
// The live radars: their watchers and controllers, their settings, and what has become of their frames.
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "server/net/live_radar.h"
#include "server/net/options.h"
#include "server/rendering/render_thread.h"

namespace obliq::net {

class ExerciseLog;

/// On the io thread.
class Radars {
 public:
  /// The options and the render thread, to which the radars are added, must outlive this.
  Radars(const ServerOptions& options, const std::vector<RadarConfig>& radars,
         rendering::RenderThread& render, ExerciseLog& log);

  const std::deque<LiveRadar>& all() const { return radars_; }
  LiveRadar& at(std::size_t number) { return radars_.at(number); }
  LiveRadar* find(const std::string& name);
  std::deque<Platform>& platforms() { return platforms_; }
  Platform* find_platform(const std::string& name);
  rendering::LiveStream::Load load(const LiveRadar& radar) const { return render_.load(radar.number()); }

  // Watchers:
  void watch(LiveRadar& radar, Peer& peer, rendering::Demand demand);
  void unsubscribe(LiveRadar& radar, const Peer& peer);
  /// After a change of watchers, of transmit or of the rate limit.
  void update_demand(LiveRadar& radar);
  /// Tells the watchers of a part of the radar's frame that is no longer there.
  void check_windows(LiveRadar& radar) const;
  void send_fault(const LiveRadar& radar, Peer& peer) const;
  /// A client gets all of that; from other clients it is taken, and they are told.
  void claim(LiveRadar& radar, wire::ClaimSet claims, Peer& by);
  /// What of that the client held, it holds no longer; the log has it. With the pose goes what its poses said
  /// of their validity and their clock.
  wire::ClaimSet release(LiveRadar& radar, wire::ClaimSet claims, const Peer& peer);
  /// A client has left: its subscriptions end, control is released.
  void forget(Peer& peer);
  /// A client's role may have become lower: it loses what the role does not allow.
  void check_role(Peer& peer);

  // How a radar looks:
  /// Settings or pose have changed.
  void publish_view(LiveRadar& radar);
  /// Another state has been put in place: it shows at once, also of a radar that is held.
  void show(LiveRadar& radar);
  /// False: the pose came late and was left out.
  bool take_pose(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time);
  /// Its antenna is turned where its platform stands or flies (PoseTimeLine::aim).
  void aim(LiveRadar& radar, const PoseSettings& as);
  /// A valid pose has come: with a sim time it joins the radar's time line, else it applies at once. False:
  /// it was late.
  bool move(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time);
  /// The same of all radars of a platform: late for one of them, as after a reset of another alone, it moves
  /// none.
  bool move(Platform& platform, const std::vector<PoseSettings>& poses, bool has_sim_time);
  /// The only place where transmit and freeze change. `by` stands in the log.
  void flip(LiveRadar& radar, const RadarSwitches& wanted, const std::string& by);
  /// Stops all radars, whatever they are switched to, or lets them go on.
  void hold(bool on);
  /// Says in the log, once, that a radar has left the ground that files cover, or has come back. Empty: it is
  /// there.
  static void note_ground(LiveRadar& radar, const std::string& warning);

  // What the render thread has told:
  void deliver(std::size_t number, const stream::LiveFramePtr& frame,
               const std::vector<stream::BlockPtr>& blocks);
  void count(std::size_t number, const rendering::RenderedFrame& frame);
  void relieve(std::size_t number, double held_up_s);
  void note_fault(std::size_t number, const rendering::LiveView& view, const std::vector<FieldError>& errors);

 private:
  void set_view(LiveRadar& radar);
  void tell_places() const;
  wire::ClaimSet take_over(LiveRadar& radar, wire::ClaimSet claims, Peer& by);
  wire::ClaimSet end_claims(LiveRadar& radar, wire::ClaimSet claims, const Peer& peer);
  /// The render thread keeps the settings and the pose of this moment.
  void hold_view(const LiveRadar& radar);
  /// A subscription loses what its client's role does not allow any more: it held the radar up, or had truth.
  void watch_as_the_role_allows(LiveRadar& radar, Peer& peer);

  const ServerOptions& options_;
  rendering::RenderThread& render_;
  ExerciseLog& log_;
  std::deque<LiveRadar> radars_;  ///< a deque: radars stay where they are
  std::deque<Platform> platforms_;
  std::uint64_t last_watch_id_ = 0;
  bool held_ = false;  ///< by hold()
};

}  // namespace obliq::net
