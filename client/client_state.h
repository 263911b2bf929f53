#pragma once
// What a Client keeps. For client*.cpp alone; include proto/obliq.pb.h before.
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "client/client.h"

namespace obliq::client {

struct Client::State {
  Connection connection;
  Endpoint endpoint;
  ClientOptions options;
  wire::Welcome welcome;
  FrameHandler* handler = nullptr;
  Tap tap;
  wire::Bytes welcome_bytes;
  std::optional<wire::ReplayState> replay_state;
  wire::Bytes payload;  ///< memory of the message before, for the next
  std::uint64_t last_request = 0;
  std::chrono::steady_clock::time_point last_heard;

  template <typename Request, typename Reply>
  Status call(wire::MessageType type, Request& request, wire::MessageType reply_type, Reply& reply) {
    return call(type, request, reply_type, reply, options.reply_timeout);
  }
  /// plane: null, or what gets the bytes behind the reply.
  template <typename Request, typename Reply>
  Status call(wire::MessageType type, Request& request, wire::MessageType reply_type, Reply& reply,
              Timeout patience, wire::Bytes* plane = nullptr) {
    request.set_request_id(++last_request);
    return exchange(
        type, request, reply_type, reply, [&reply] { return reply.request_id(); }, patience, plane);
  }
  /// Of a request that has its number: until the reply has the same.
  Status exchange(wire::MessageType type, const google::protobuf::MessageLite& request,
                  wire::MessageType reply_type, google::protobuf::MessageLite& reply,
                  const std::function<std::uint64_t()>& number, Timeout patience, wire::Bytes* plane);
  Status explain_silence(Status status) const;
  template <typename Request>
  Status acknowledged(wire::MessageType type, Request& request) {
    wire::Ack ack;
    return call(type, request, wire::MessageType::ack, ack);
  }
  Status receive(Message& message, Timeout timeout);
  Status receive_and_handle(Message& message, Timeout timeout);
  Status dispatch(const Message& message);
  Status keep_replay_state(const Message& message);
  Status hand_on_events(const Message& message);
  Status demand_1_2() const;
  Status refused_pose(const wire::Error& error);
  Status unsolicited(const Message& message);
  Status doubt_server(Status status);
};

/// A request that names a radar.
template <typename Request>
Request about(const std::string& radar) {
  Request request;
  request.set_radar(radar);
  return request;
}

}  // namespace obliq::client
