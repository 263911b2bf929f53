#pragma once
#include <string>

namespace google::protobuf {
class Message;
}
namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// frame.json: every field of descriptor and summary under its protobuf name, and the bin edges. Numbers are
/// written so that they read back to the same double; infinity, which JSON lacks, as "inf".
std::string frame_json(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary);

/// Every field of a message under its protobuf name, in one line.
std::string message_json(const google::protobuf::Message& message);

/// The scene file's word for a protobuf enumerator: GROUND_SPECKLE is "ground".
std::string enum_word(std::string enumerator);

}  // namespace obliq
