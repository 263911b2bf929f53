#include "client/client.h"

#include <cstdio>
#include <utility>

#include "client/frame_dispatch.h"
#include "proto/error_number.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
// After the messages:
#include "client/client_state.h"

namespace obliq::client {

using wire::MessageType;
using Clock = std::chrono::steady_clock;

// Heartbeats that may fail to come before a server is taken for dead: any may be late.
constexpr int kHeartbeatsMissed = 3;
/// Of requests whose answers nobody waits for.
constexpr std::uint64_t kSent = std::uint64_t{1} << 63;

namespace {

template <typename Request>
void name_kinds(wire::ClaimSet claims, Request& request) {
  wire::for_each_claim(claims,
                       [&](wire::Claim claim) { request.add_kinds(static_cast<wire::ClaimKind>(claim)); });
}

// Others may ask whether this client is there, at any time.
Status answer_heartbeat(Connection& connection, const Message& message) {
  wire::Heartbeat asked;
  if (!wire::parse_descriptor(message.descriptor(), asked)) return unreadable("Heartbeat");
  if (!asked.answer_wanted()) return {};
  wire::Heartbeat answer;
  answer.set_request_id(asked.request_id());
  return connection.send(MessageType::heartbeat, answer);
}

}  // namespace

Status Client::State::receive(Message& message, Timeout timeout) {
  if (Status status = connection.receive(message, timeout); !status.ok()) return status;
  return tap ? tap(message) : Status{};
}

Status Client::State::exchange(MessageType type, const google::protobuf::MessageLite& request,
                               MessageType reply_type, google::protobuf::MessageLite& reply,
                               const std::function<std::uint64_t()>& number, Timeout patience,
                               wire::Bytes* plane) {
  const Status sent = connection.send(type, request);
  if (!sent.ok() && sent.outcome != Outcome::closed) return sent;
  // Where sending failed because the server has closed, its last words may still wait to be read.
  for (;;) {
    Message message;
    if (Status status = receive(message, patience); !status.ok()) return sent.ok() ? status : sent;
    last_heard = Clock::now();
    if (message.header.type == reply_type) {
      if (!wire::parse_descriptor(message.descriptor(), reply)) return unreadable("answer");
      if (number() == last_request) {
        if (reply_type == MessageType::welcome) welcome_bytes = message.bytes();
        if (plane != nullptr) plane->assign(message.plane().begin(), message.plane().end());
        return {};
      }
      if (reply_type == MessageType::exercise_events)
        if (Status status = hand_on_events(message); !status.ok()) return status;
    } else if (message.header.type == MessageType::error) {
      wire::Error error;
      if (!wire::parse_descriptor(message.descriptor(), error)) return unreadable("Error");
      // Faults of a radar that answer nothing do not concern this call; those of the connection do.
      if (error.request_id() == last_request || error.number() < 100) return Status::from_error(error);
      if (Status status = refused_pose(error); !status.ok()) return status;
    } else if (message.header.type == MessageType::heartbeat) {
      if (Status status = answer_heartbeat(connection, message); !status.ok()) return status;
    } else if (message.header.type == MessageType::replay_state) {
      if (Status status = keep_replay_state(message); !status.ok()) return status;
    } else if (message.header.type == MessageType::exercise_events) {
      if (Status status = hand_on_events(message); !status.ok()) return status;
    } else if (is_frame(message.header.type)) {
      if (Status status = dispatch(message); !status.ok()) return status;
    }
  }
}

// Of a Hello without an answer: what may listen there.
Status Client::State::explain_silence(Status status) const {
  char silence[32];
  std::snprintf(silence, sizeof silence, "%.3g",
                std::chrono::duration<double>(options.hello_timeout).count());
  if (status.outcome == Outcome::timed_out)
    status.text = std::string("something accepts connections there, but has sent nothing for ") + silence +
                  " s: it is not obliqd, or too busy to answer";
  if (status.outcome == Outcome::closed)
    status.text += "; it accepted the connection and sent nothing: is it obliqd?";
  return status;
}

// Nothing has come, nor waits to be read: a server that is there would have sent heartbeats.
Status Client::State::doubt_server(Status status) {
  const double patience_s = kHeartbeatsMissed * welcome.limits().heartbeat_s();
  const std::chrono::duration<double> silence = Clock::now() - last_heard;
  if (status.outcome != Outcome::timed_out || patience_s <= 0 || silence.count() < patience_s) return status;
  connection.close();
  return Status::failure(Outcome::closed, "the server has said nothing for " +
                                              std::to_string(static_cast<int>(silence.count())) + " s");
}

Status Client::State::dispatch(const Message& message) {
  FrameHandler none;
  return dispatch_frame(message.header, message.descriptor(), message.plane(),
                        handler != nullptr ? *handler : none);
}

Status Client::State::refused_pose(const wire::Error& error) {
  if ((error.request_id() & kSent) == 0 || handler == nullptr) return {};
  return handler->on_refused_pose(Status::from_error(error));
}

// A message that answers no call. Anything but an Error is skipped.
Status Client::State::unsolicited(const Message& message) {
  if (message.header.type != MessageType::error) return {};
  wire::Error error;
  if (!wire::parse_descriptor(message.descriptor(), error)) return unreadable("Error");
  return (error.request_id() & kSent) != 0 ? refused_pose(error) : Status::from_error(error);
}

Status Client::State::keep_replay_state(const Message& message) {
  wire::ReplayState state;
  if (!wire::parse_descriptor(message.descriptor(), state)) return unreadable("ReplayState");
  replay_state = std::move(state);
  return {};
}

Client::Client() : state_(std::make_unique<State>()) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

Status Client::connect(const Endpoint& endpoint, const ClientOptions& options) {
  state_->endpoint = endpoint;
  state_->options = options;
  if (Status status = Connection::open(endpoint, options.tls, options.connect_timeout, state_->connection);
      !status.ok())
    return status;
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  hello.set_minor(wire::kMinorVersion);
  hello.set_token(options.token);
  hello.set_client_name(options.name.substr(0, wire::kMaxNameBytes));
  Status status = state_->explain_silence(
      state_->call(MessageType::hello, hello, MessageType::welcome, state_->welcome, options.hello_timeout));
  const wire::Welcome& welcome = state_->welcome;
  if (status.ok() && welcome.major() != wire::kMajorVersion)
    status = Status::failure(Outcome::bad_stream,
                             "the server's protocol version: found " + std::to_string(welcome.major()) + "." +
                                 std::to_string(welcome.minor()) +
                                 "; allowed: " + std::to_string(wire::kMajorVersion) + ".x");
  if (!status.ok()) {
    status.text = endpoint.text() + ": " + status.text;
    state_->connection.close();
  }
  return status;
}

Status Client::reconnect() {
  state_->connection.close();
  if (state_->handler != nullptr) state_->handler->on_lost();
  state_->welcome.Clear();
  state_->replay_state.reset();
  const Endpoint endpoint = state_->endpoint;
  ClientOptions options = state_->options;
  options.hello_timeout = options.reply_timeout;  // that it is obliqd is known
  return connect(endpoint, options);
}

const wire::Welcome& Client::welcome() const { return state_->welcome; }
const wire::Bytes& Client::welcome_bytes() const { return state_->welcome_bytes; }
void Client::set_handler(FrameHandler* handler) { state_->handler = handler; }
void Client::set_tap(Tap tap) { state_->tap = std::move(tap); }
bool Client::is_open() const { return state_->connection.is_open(); }
void Client::close() { state_->connection.close(); }

Status Client::list_radars(wire::RadarList& list) {
  wire::ListRadars request;
  return state_->call(MessageType::list_radars, request, MessageType::radar_list, list);
}

Status Client::get_radar(const std::string& radar, wire::RadarInfo& info) {
  auto request = about<wire::GetRadar>(radar);
  return state_->call(MessageType::get_radar, request, MessageType::radar_info, info);
}

Status Client::claim_control(const std::string& radar, bool force) { return claim(radar, {}, force); }

Status Client::claim(const std::string& radar, wire::ClaimSet claims, bool force) {
  auto request = about<wire::ClaimControl>(radar);
  request.set_force(force);
  name_kinds(claims, request);
  return state_->acknowledged(MessageType::claim_control, request);
}

Status Client::release(const std::string& radar, wire::ClaimSet claims) {
  auto request = about<wire::ReleaseControl>(radar);
  name_kinds(claims, request);
  return state_->acknowledged(MessageType::release_control, request);
}

Status Client::release_control(const std::string& radar) { return release(radar, {}); }

Status Client::set_settings(const std::string& radar, const wire::RadarSettings& settings, wire::Ack& ack) {
  auto request = about<wire::SetSettings>(radar);
  *request.mutable_settings() = settings;
  return state_->call(MessageType::set_settings, request, MessageType::ack, ack);
}

Status Client::set_pose(const std::string& radar, const wire::Pose& pose, wire::Ack& ack) {
  auto request = about<wire::SetPose>(radar);
  *request.mutable_pose() = pose;
  return state_->call(MessageType::set_pose, request, MessageType::ack, ack);
}

Status Client::send_pose(const std::string& radar, const wire::Pose& pose) {
  auto request = about<wire::SetPose>(radar);
  *request.mutable_pose() = pose;
  request.set_request_id(kSent | ++state_->last_request);
  if (Status sent = state_->connection.send(MessageType::set_pose, request);
      !sent.ok() && sent.outcome != Outcome::closed)
    return sent;
  // Answers that nobody took would fill the connection.
  for (;;) {
    Status status = receive(Timeout{0});
    if (status.outcome == Outcome::timed_out) return {};
    if (!status.ok()) return status;
  }
}

Status Client::set_state(const std::string& radar, std::optional<bool> transmit, std::optional<bool> freeze) {
  auto request = about<wire::SetState>(radar);
  if (transmit) request.set_transmit(*transmit);
  if (freeze) request.set_freeze(*freeze);
  return state_->acknowledged(MessageType::set_state, request);
}

Status Client::subscribe(const std::string& radar, double rate_hz, wire::PlaneSet planes) {
  auto request = about<wire::Subscribe>(radar);
  request.set_rate_hz(rate_hz);
  for (int plane = 0; plane < wire::kPlanes; ++plane)
    if ((planes >> plane) & 1) request.add_planes(static_cast<wire::PlaneKind>(plane));
  return subscribe(request);
}

Status Client::subscribe(wire::Subscribe& request) {
  return state_->acknowledged(MessageType::subscribe, request);
}

Status Client::unsubscribe(const std::string& radar) {
  auto request = about<wire::Unsubscribe>(radar);
  return state_->acknowledged(MessageType::unsubscribe, request);
}

Status Client::render_once(wire::RenderOnce& request) {
  return state_->acknowledged(MessageType::render_once, request);
}

Status Client::get_status(wire::Status& status) {
  wire::GetStatus request;
  return state_->call(MessageType::get_status, request, MessageType::status, status);
}

Status Client::query_ground(wire::QueryGround& request, wire::GroundAnswer& answer,
                            std::vector<wire::GroundRecord>& records) {
  records.clear();
  // A server of before skips the request, and nothing would come.
  if (state_->welcome.limits().max_query_points() == 0)
    return Status::failure(Outcome::bad_argument,
                           "this server answers no ground queries: it replays a recording, or is too old");
  wire::Bytes bytes;
  if (Status status = state_->call(MessageType::query_ground, request, MessageType::ground_answer, answer,
                                   state_->options.reply_timeout, &bytes);
      !status.ok())
    return status;
  if (wire::decode_ground_records(bytes, answer.points(), answer.record_bytes(), records)) return {};
  return Status::failure(Outcome::bad_stream, "GroundAnswer: found " + std::to_string(bytes.size()) +
                                                  " bytes for " + std::to_string(answer.points()) +
                                                  " records of " + std::to_string(answer.record_bytes()));
}

Status Client::receive(Timeout timeout) {
  Message message;
  message.payload = std::move(state_->payload);
  Status status = state_->receive_and_handle(message, timeout);
  state_->payload = std::move(message.payload);
  return status;
}

Status Client::State::receive_and_handle(Message& message, Timeout timeout) {
  if (Status status = receive(message, timeout); !status.ok()) return doubt_server(std::move(status));
  last_heard = Clock::now();
  if (message.header.type == MessageType::heartbeat) return answer_heartbeat(connection, message);
  if (message.header.type == MessageType::replay_state) return keep_replay_state(message);
  if (message.header.type == MessageType::exercise_events) return hand_on_events(message);
  return is_frame(message.header.type) ? dispatch(message) : unsolicited(message);
}

}  // namespace obliq::client
