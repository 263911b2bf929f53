#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/error_number.h"
#include "proto/message_type.h"
#include "server/rendering/render_events.h"
#include "server/security/token_file.h"
#include "server/stream/outbox.h"

namespace google::protobuf {
class Message;
}

namespace obliq::net {

/// A request as it came.
struct KeptRequest {
  wire::MessageType type;
  wire::Bytes descriptor;
};

/// One client as the room sees it. The session behind it owns the socket.
class Peer {
 public:
  Peer(std::uint64_t peer_id, std::string peer_host, std::string peer_address, bool peer_takes_json,
       int queue_frames, std::size_t queue_bytes)
      : id(peer_id),
        host(std::move(peer_host)),
        address(std::move(peer_address)),
        takes_json(peer_takes_json),
        outbox(queue_frames, queue_bytes) {}
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// Queues a control message.
  void send(wire::MessageType type, const google::protobuf::Message& message) { send(type, message, {}); }
  /// The same with plane data behind it.
  virtual void send(wire::MessageType type, const google::protobuf::Message& message,
                    std::span<const std::byte> plane) = 0;
  /// The outbox has something to write.
  virtual void kick() = 0;
  /// Sends an Error and closes once it has been written; begun frames are aborted.
  virtual void fail(wire::ErrorNumber number, const std::string& text) = 0;
  /// As fail(), after everything that waits in the outbox has been written.
  virtual void finish(wire::ErrorNumber number, const std::string& text) = 0;

  /// Closes at once, without an Error.
  virtual void drop() = 0;

  bool is_client() const { return greeted && !has_left; }
  bool is_waiting() const { return !greeted && !has_left; }  ///< has not said Hello

  const std::uint64_t id;
  const std::string host;          ///< "127.0.0.1"
  const std::string address;       ///< "127.0.0.1:50000"
  const bool takes_json;           ///< as the descriptors of all messages
  bool owes_replay_state = false;  ///< where a replay is has changed since this peer was told
  std::string name;                ///< as shown to others: what it calls itself, and where it is
  bool greeted = false;            ///< Hello has been answered
  bool has_left = false;           ///< its connection has ended; the room forgets it soon
  security::Role role = security::Role::viewer;
  std::optional<security::TokenDigest> credential;  ///< its token, where tokens are configured
  stream::Outbox outbox;
  bool follows_events = false;  ///< gets each event of the exercise
  int subscriptions = 0;
  std::vector<rendering::FrameRequestPtr> renders;  ///< not finished
  int queries = 0;                                  ///< of the ground, not answered
  rendering::AppraisalPtr appraisal;                ///< that is under way
  std::deque<KeptRequest> in_turn;  ///< the request that it is for, and those that come after it

  // For the log:
  const std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  std::string introduction;
  std::uint64_t asked = 0;  ///< a bit for each type of request
  bool has_moved = false;   ///< a radar, once
  bool is_guest = false;    ///< it watches or flies: more than a passer-by
};

// What the log says of connections. A client that watches or flies gets a line when that begins and one when
// it leaves; one that only asks something gets a single line, at its end; one that only sets a pose gets
// none. The level debug shows all of them as they happen.

/// Hello was answered. `introduction`: the role, and the name of the token.
void log_arrival(Peer& peer, const std::string& introduction);
/// A request has arrived.
void log_request(Peer& peer, wire::MessageType type);
/// It is more than a passer-by: from now on what it does is logged at once.
void log_as_guest(Peer& peer);
/// What it does with a radar.
void log_doing(const Peer& peer, const std::string& radar, const std::string& what);
void log_end(const Peer& peer);

/// What an operator can do about a client that was closed with this error; begins with "; ", or is empty.
std::string_view advice(wire::ErrorNumber number);

}  // namespace obliq::net
