#pragma once
#include <string>
#include <vector>

namespace google::protobuf {
class Message;
}
namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// frame.json: every field of descriptor and summary under its protobuf name, the planes that have files,
/// notes on what is not plain, and last the bin edges. Numbers are written so that they read back to the same
/// double; infinity, which JSON lacks, as null.
std::string frame_json(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                       const std::vector<std::string>& planes);

/// Every field of a message under its protobuf name, in one line.
std::string message_json(const google::protobuf::Message& message);

/// The scene file's word for a protobuf enumerator: GROUND_SPECKLE is "ground".
std::string enum_word(std::string enumerator);

}  // namespace obliq
