#pragma once
#include <optional>
#include <string>

#include "client/socket.h"
#include "tests/integration/session/session_record.h"
#include "tests/integration/web_peer.h"

namespace obliq::test {

enum class Door { tcp, web };

/// A connection of its own; what it sends and reads goes into the record.
class RecordedPeer {
 public:
  RecordedPeer(SessionRecord& record, std::string name, const client::Endpoint& server, Door door);

  /// The fields as protobuf's text format has them; the request_id is the number of the message.
  void send(wire::MessageType type, const std::string& fields = "");
  /// Sends, and reads as read() does.
  void ask(wire::MessageType type, const std::string& fields, wire::MessageType until, int times = 1);
  /// `what` is for the record.
  void send_bytes(const std::string& what, const wire::Bytes& bytes);
  /// Reads until so many messages of that type have come; the test fails if the server closes before.
  void read(wire::MessageType until, int times = 1);
  void read_to_the_end();

 private:
  bool read_one(wire::MessageType& type);  ///< false: nothing more comes

  SessionRecord& record_;
  std::string name_;
  client::Socket socket_;
  std::optional<WebPeer> web_;  ///< instead of the socket
  std::uint64_t sequence_ = 0;
};

}  // namespace obliq::test
