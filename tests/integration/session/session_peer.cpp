#include "tests/integration/session/session_peer.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "proto/limits.h"
#include "tests/integration/clients.h"

namespace obliq::test {

using google::protobuf::Message;
using wire::MessageType;

RecordedPeer::RecordedPeer(SessionRecord& record, std::string name, const client::Endpoint& server, Door door)
    : record_(record), name_(std::move(name)) {
  if (door == Door::web) {
    web_.emplace(server);
    EXPECT_EQ(web_->status(), 101) << web_->answer();
    return;
  }
  EXPECT_TRUE(is_ok(client::Socket::connect(server, kLong, socket_)));
}

void RecordedPeer::send(MessageType type, const std::string& fields) {
  const std::unique_ptr<Message> message = empty_message(type);
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(fields, message.get())) << fields;
  message->GetReflection()->SetUInt64(message.get(), message->GetDescriptor()->FindFieldByName("request_id"),
                                      ++sequence_);
  record_.sent(name_, type, *message);
  if (web_) return web_->send(type, json_of(*message));
  const auto bytes = wire::encode_message(type, {0, sequence_, wire::utc_now_ns()}, *message);
  EXPECT_TRUE(socket_.send(bytes, kLong).ok());
}

void RecordedPeer::ask(MessageType type, const std::string& fields, MessageType until, int times) {
  send(type, fields);
  read(until, times);
}

void RecordedPeer::send_bytes(const std::string& what, const wire::Bytes& bytes) {
  record_.note(name_ + " > " + what);
  EXPECT_TRUE(socket_.send(bytes, kLong).ok());
}

bool RecordedPeer::read_one(MessageType& type) {
  wire::Bytes bytes(wire::kHeaderBytes);
  if (web_) {
    const auto message = web_->read();
    if (!message) return false;
    bytes = as_protobuf(*message);
    wire::MessageView view;
    EXPECT_EQ(wire::decode_message(bytes, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
    type = view.header.type;
    return record_.received(name_, view);
  }
  if (!socket_.receive(bytes, kLong).ok()) return false;
  wire::MessageHeader header;
  const auto status =
      wire::decode_header(std::span(bytes).first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header);
  EXPECT_EQ(status, wire::HeaderStatus::ok);
  if (status != wire::HeaderStatus::ok) return false;
  bytes.resize(header.header_length + header.payload_length);
  if (!socket_.receive(std::span(bytes).subspan(wire::kHeaderBytes), kLong).ok()) return false;
  wire::MessageView view;
  EXPECT_EQ(wire::decode_message(bytes, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
  type = header.type;
  return record_.received(name_, view);
}

void RecordedPeer::read(MessageType until, int times) {
  while (times > 0) {
    MessageType type{};
    if (!read_one(type)) {
      ADD_FAILURE() << name_ << " waits for " << facts_of(until).name
                    << "; the last line: " << record_.last_line();
      throw std::runtime_error("the session has ended early");
    }
    if (type == until) --times;
  }
}

void RecordedPeer::read_to_the_end() {
  for (MessageType type{}; read_one(type);) {
  }
  record_.note(name_ + " < closed");
}

}  // namespace obliq::test
