#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/claim.h"
#include "proto/error_number.h"
#include "proto/message_type.h"
#include "proto/plane.h"
#include "server/security/token_file.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class Error;
class Hello;
class Heartbeat;
class ListRadars;
class GetRadar;
class ClaimControl;
class ReleaseControl;
class SetSettings;
class SetPose;
class SetState;
class SetReplay;
class Subscribe;
class Unsubscribe;
class RenderOnce;
class GetStatus;
class QueryGround;
class ResetExercise;
class GetExercise;
class LoadExercise;
class SetExercise;
class GetEvents;
class AddBookmark;
class SetTargets;
class GetTargets;
class RadarStatus;
class Pose;
}  // namespace obliq::wire

namespace obliq {
struct KeeperState;
struct PoseSettings;
struct RadarSettings;
}  // namespace obliq

namespace obliq::net {

class Peer;
class Room;
struct LiveRadar;
struct OverLimit;
struct Platform;
struct Right;

wire::Error make_error(std::uint64_t request_id, wire::ErrorNumber number, const std::string& text,
                       const std::vector<FieldError>& fields = {}, const std::string& radar = {});

/// Text from a peer, made fit for a log and a terminal: at most wire::kMaxNameBytes, control characters and
/// bytes beyond ASCII replaced.
std::string presentable(const std::string& text);

/// What a RenderOnce must name: there is no radar to take it from.
std::vector<FieldError> missing_position(const wire::Pose& pose);

/// Why a radar that rides is not placed by itself.
FieldError no_pose_of_its_own(const LiveRadar& radar, const std::string& field);
/// Why a radar's antenna cannot stand like that, although its numbers are within their limits.
std::vector<FieldError> pose_faults(const Room& room, const LiveRadar& radar, const PoseSettings& pose);

/// What the render thread has said of a request's settings.
struct Appraised {
  std::uint64_t version = 0;  ///< of the radar's settings that they were a change of
  std::vector<FieldError> faults;
};

/// Answers the requests of one peer: one function per message. Every request gets exactly one answer; that of
/// SetSettings, Subscribe and RenderOnce may have to wait for the render thread, and those of further ones
/// behind it.
class Requests {
 public:
  Requests(Room& room, Peer& peer) : room_(room), peer_(peer) {}
  /// For a request that was kept and is handled again. appraised: null where it only came after another.
  Requests(Room& room, Peer& peer, const Appraised* appraised)
      : room_(room), peer_(peer), appraised_(appraised), its_turn_(true) {}
  /// Of the request that was handled: it has no answer yet, and must be handled again.
  bool is_kept() const { return is_kept_; }
  void handle(wire::MessageType type, std::span<const std::byte> descriptor);

 private:
  template <typename Request>
  void answer(std::span<const std::byte> descriptor, void (Requests::*function)(const Request&));
  void handle_greeted(wire::MessageType type, std::span<const std::byte> descriptor);

  void hello(const wire::Hello& request);
  void heartbeat(const wire::Heartbeat& request);
  void list_radars(const wire::ListRadars& request);
  void get_radar(const wire::GetRadar& request);
  void claim_control(const wire::ClaimControl& request);
  void release_control(const wire::ReleaseControl& request);
  void set_settings(const wire::SetSettings& request);
  void set_pose(const wire::SetPose& request);
  void set_state(const wire::SetState& request);
  void set_replay(const wire::SetReplay& request);
  void subscribe(const wire::Subscribe& request);
  void unsubscribe(const wire::Unsubscribe& request);
  void render_once(const wire::RenderOnce& request);
  void get_status(const wire::GetStatus& request);
  void query_ground(const wire::QueryGround& request);
  void reset_exercise(const wire::ResetExercise& request);
  void get_exercise(const wire::GetExercise& request);
  void load_exercise(const wire::LoadExercise& request);
  void set_exercise(const wire::SetExercise& request);
  void get_events(const wire::GetEvents& request);
  void add_bookmark(const wire::AddBookmark& request);
  void set_targets(const wire::SetTargets& request);
  void get_targets(const wire::GetTargets& request);

  /// Whether it has to come after requests that are kept; or it is refused, because they are too many.
  bool comes_later();
  /// What is wrong with beam and pulse. Nothing: the render thread has been asked, which knows the ground,
  /// and the request is kept. version: of the radar's settings that these are a change of.
  std::optional<std::vector<FieldError>> beam_faults_of(const RadarSettings& settings, std::uint64_t version,
                                                        const PoseSettings& pose);
  /// False after a refusal that says what `action` needs.
  bool demand(security::Role needed, const std::string& action);
  bool may_have_truth() const;
  bool demand_truth();
  void acknowledge(std::uint64_t settings_version = 0);
  /// Of a radar, in Status: how much of its ground is known, and why not more.
  void write_coverage(const LiveRadar& radar, const KeeperState& keeper, wire::RadarStatus& entry) const;
  void refuse(const OverLimit& over);
  void refuse(wire::ErrorNumber number, const std::string& text, const std::vector<FieldError>& fields = {});
  /// The radar, or null after a refusal.
  LiveRadar* radar_of(const std::string& name);
  /// As radar_of, and this peer must have what the request takes.
  LiveRadar* claimed_radar(const std::string& name);
  /// False after a refusal: this peer does not hold all of that.
  bool demand_claims(const LiveRadar& radar, wire::ClaimSet claims);
  /// The same of one radar, or of all (null); an admin has them where the request says so.
  bool demand_exercise(const LiveRadar* one);
  /// In place of seek_bookmark, the time that it stands for.
  std::vector<FieldError> find_bookmark(wire::SetReplay& request);
  /// SetPose of the peer that flies the radar, and of one that only turns its antenna. The Ack follows.
  void fly(LiveRadar& radar, const wire::Pose& message);
  void aim(LiveRadar& radar, const wire::Pose& message);
  void acknowledge_pose(std::span<LiveRadar* const> radars, const std::vector<std::string>& warnings);
  /// The same requests of a platform: of all its radars at once, or of none.
  void claim(Platform& platform, const wire::ClaimControl& request);
  void release(Platform& platform, const wire::ReleaseControl& request);
  void fly(Platform& platform, const wire::Pose& message);
  /// Of the world's targets.
  void claim_targets(const wire::ClaimControl& request);
  void release_targets();
  bool demand_targets();
  void describe(const Platform& platform);
  void log_flight(const std::string& what);

  Room& room_;
  Peer& peer_;
  const Appraised* appraised_ = nullptr;
  const Right* right_ = nullptr;  ///< what the request takes; null: nothing
  std::uint64_t id_ = 0;          ///< the request's number
  bool its_turn_ = false;         ///< no kept request comes before it
  bool is_kept_ = false;
};

}  // namespace obliq::net
