#pragma once
// Talks to an obliqd: one call per request, frames to a handler. Blocking, for one thread at a time.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/connection.h"
#include "client/frame_dispatch.h"
#include "proto/claim.h"
#include "proto/ground_record.h"
#include "proto/plane.h"

namespace obliq::wire {
class Welcome;
class RadarInfo;
class RadarList;
class RadarSettings;
class Pose;
class RenderOnce;
class Status;
class Subscribe;
class Ack;
class QueryGround;
class GroundAnswer;
class SetReplay;
class ReplayState;
class ExerciseState;
class ExerciseEvents;
class SetTargets;
class TargetList;
}  // namespace obliq::wire

namespace obliq::client {

struct ClientOptions {
  std::string name = "client";  ///< shown to others while this client holds control
  std::string token{};          ///< where the server wants one
  TlsOptions tls{};
  Timeout connect_timeout{5000};
  Timeout reply_timeout{30000};
  Timeout hello_timeout{30000};  ///< for the answer to the first connection's Hello
};

class Client {
 public:
  Client();
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  /// Connects and exchanges Hello and Welcome.
  Status connect(const Endpoint& endpoint, const ClientOptions& options = {});
  /// Once more, to the same server with the same options: what was asked for on the connection before is
  /// forgotten, its current frame is lost (FrameHandler::on_lost).
  Status reconnect();
  const wire::Welcome& welcome() const;
  /// The message that brought it, byte for byte.
  const wire::Bytes& welcome_bytes() const;

  /// Who gets frames, also those that arrive while a request waits for its answer. Not owned; may be null.
  void set_handler(FrameHandler* handler);

  /// Sees every message as it arrived, before it is handled; a status that is not ok ends the call with it.
  using Tap = std::function<Status(const Message&)>;
  void set_tap(Tap tap);

  Status list_radars(wire::RadarList& list);
  Status get_radar(const std::string& radar, wire::RadarInfo& info);
  /// Pose and settings. force: also from another client, for an admin.
  Status claim_control(const std::string& radar, bool force = false);
  /// These alone: a host that flies the radar takes its pose, an operator its settings. All of them or none.
  /// A server of version 1.1 gives both, whatever is asked for.
  Status claim(const std::string& radar, wire::ClaimSet claims, bool force = false);
  /// All that this client holds.
  Status release_control(const std::string& radar);
  Status release(const std::string& radar, wire::ClaimSet claims);
  Status set_settings(const std::string& radar, const wire::RadarSettings& settings, wire::Ack& ack);
  Status set_pose(const std::string& radar, const wire::Pose& pose, wire::Ack& ack);
  /// As set_pose without its answer: for a host that moves the antenna in a loop of its own. Handles what has
  /// arrived meanwhile and waits for nothing; a refusal comes to FrameHandler::on_refused_pose, in this or a
  /// later call.
  Status send_pose(const std::string& radar, const wire::Pose& pose);
  /// Transmit and freeze, on or off; nothing leaves one as it is.
  Status set_state(const std::string& radar, std::optional<bool> transmit, std::optional<bool> freeze);
  Status subscribe(const std::string& radar, double rate_hz, wire::PlaneSet planes = wire::kAllPlanes);
  /// As the request says; its request_id is set.
  Status subscribe(wire::Subscribe& request);
  Status unsubscribe(const std::string& radar);
  /// Queues a frame; it then arrives at the handler with the request's number, which is stored in `request`.
  Status render_once(wire::RenderOnce& request);
  Status get_status(wire::Status& status);
  // Targets of the world, of a server of version 1.2:
  /// This client alone may set them. force: also from another client, for an admin.
  Status claim_targets(bool force = false);
  Status release_targets();
  /// All of it or nothing; what one message does not hold goes in several, and still at once. warnings: of
  /// what was left out.
  Status set_targets(const wire::SetTargets& change, std::vector<std::string>& warnings);
  /// All there are, with what else a TargetList says. Needs the server's truth role.
  Status get_targets(wire::TargetList& list);
  // The exercise: all radars of a server of version 1.2. What needs both claims of all of them an admin may
  // do without.
  Status get_exercise(wire::ExerciseState& state);
  /// All of it or nothing. With more targets than one message holds: first all else, then the targets, which
  /// are claimed.
  Status load_exercise(const wire::ExerciseState& state);
  /// To the scene file's settings, pose and switches. Empty: all radars.
  Status reset_exercise(const std::string& radar);
  /// Clock, antenna and noise of all radars stand, for all clients, or go on.
  Status freeze_exercise(bool on);
  /// Who changed what of the exercise: the events behind number `after`, as many as fit into one answer (then
  /// `more` is set). follow: once an answer is complete, later ones come to FrameHandler::on_events by
  /// themselves. with_state: such an answer has the exercise's state behind its events.
  Status get_events(std::uint64_t after, bool follow, wire::ExerciseEvents& events, bool with_state = false);
  /// For all stations; in a replay at its place. At most 1000 bytes; for a controller.
  Status add_bookmark(const std::string& text);
  /// Pauses a replay, changes its speed or its place, for all that watch it. request's number is set. Refused
  /// with error 126 by a server whose radars are live.
  Status set_replay(wire::SetReplay& request);
  /// The newest that has come, where the server replays; null: none. Valid until the next call that receives.
  const wire::ReplayState* replay_state() const;
  /// What is at up to Limits.max_query_points places, and whether an antenna sees points there: a record for
  /// each, in their order. request's number is set.
  Status query_ground(wire::QueryGround& request, wire::GroundAnswer& answer,
                      std::vector<wire::GroundRecord>& records);

  /// Waits for one message and hands it to the handler; types that are not known are skipped. timed_out
  /// leaves the connection usable; after three heartbeats that did not come it is closed instead. An Error
  /// that answers no request ends the call with `refused`.
  Status receive(Timeout timeout);

  bool is_open() const;
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::client
