#pragma once
// What clients and a server say to each other, as lines of text that are the same in every session: what
// depends on the time, on the machine or on our wording is masked.
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "proto/message_codec.h"

namespace google::protobuf {
class Message;
}

namespace obliq::test {

/// What the protocol says of a type: null for a number that is none.
struct TypeFacts {
  const char* name = nullptr;  ///< of the protobuf message
  bool by_client = false;
  bool by_server = false;
};
TypeFacts facts_of(wire::MessageType type);
std::unique_ptr<google::protobuf::Message> empty_message(wire::MessageType type);

/// A line a message:
///   viewer > GetRadar {request_id: 2 radar: "main"}
///   viewer < RadarInfo 0/2 HASH {request_id: 2 ...}
/// With stream_id/sequence of the header, and the hash of the protobuf part's bytes, masked. Behind a
/// WedgeBlock's hash: length and hash of its values; of compressed ones, whose bytes depend on the version of
/// libzstd, those of the plain values.
class SessionRecord {
 public:
  void note(const std::string& line) { lines_.push_back(line); }
  void sent(const std::string& who, wire::MessageType type, const google::protobuf::Message& message);
  /// False, and the running test fails, when it is no message as the protocol has it.
  bool received(const std::string& who, const wire::MessageView& view);

  void write(const std::string& file) const;
  /// The running test fails where the file says something else, up to its line `until`, if that is given.
  void compare(const std::string& file, const std::string& until = "") const;

  const std::string& last_line() const { return lines_.back(); }
  /// Of a stream, for any watcher.
  std::uint64_t frames_ended(std::uint32_t stream_id) const;
  bool was_sent(wire::MessageType type) const { return sent_.contains(type); }
  bool was_received(wire::MessageType type) const { return received_.contains(type); }

 private:
  std::vector<std::string> lines_;
  std::set<wire::MessageType> sent_;
  std::set<wire::MessageType> received_;
  std::map<std::uint32_t, std::set<std::uint64_t>> ended_;  ///< sequence numbers of the FrameEnds
};

}  // namespace obliq::test
