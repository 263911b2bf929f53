#include "proto/message_codec.h"

#include <google/protobuf/message_lite.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace obliq::wire {

Bytes encode_message(MessageType type, const Addressing& addressing,
                     const google::protobuf::MessageLite& descriptor, std::span<const std::byte> plane,
                     std::uint32_t max_descriptor_bytes, Bytes memory) {
  const std::size_t descriptor_bytes = descriptor.ByteSizeLong();
  if (descriptor_bytes > max_descriptor_bytes || plane.size() > kMaxPlaneBytes) return {};

  MessageHeader header;
  header.type = type;
  header.descriptor_length = static_cast<std::uint32_t>(descriptor_bytes);
  header.payload_length = static_cast<std::uint32_t>(descriptor_bytes + plane.size());
  header.stream_id = addressing.stream_id;
  header.sequence = addressing.sequence;
  header.utc_ns = addressing.utc_ns;

  // Plane data is most of a message: its bytes are written once, not zeroed first.
  Bytes bytes = std::move(memory);
  bytes.clear();
  bytes.reserve(kHeaderBytes + header.payload_length);
  bytes.resize(kHeaderBytes + descriptor_bytes);
  bytes.insert(bytes.end(), plane.begin(), plane.end());
  const std::span<std::byte> all(bytes);
  const auto head = all.first<kHeaderBytes>();
  const auto payload = all.subspan(kHeaderBytes);
  if (!descriptor.SerializeToArray(payload.data(), static_cast<int>(descriptor_bytes))) return {};
  encode_header(header, head);
  header.crc = message_crc(head, payload);
  encode_header(header, head);
  return bytes;
}

MessageStatus decode_message(std::span<const std::byte> bytes, const MessageLimits& limits,
                             MessageView& view) {
  if (bytes.size() < kHeaderBytes) return MessageStatus::need_more;
  switch (decode_header(bytes.first<kHeaderBytes>(), limits, view.header)) {
    case HeaderStatus::ok:
      break;
    case HeaderStatus::bad_magic:
      return MessageStatus::bad_magic;
    case HeaderStatus::version_mismatch:
      return MessageStatus::version_mismatch;
    case HeaderStatus::bad_length:
      return MessageStatus::bad_length;
  }
  const std::size_t header_bytes = view.header.header_length;
  view.size = header_bytes + view.header.payload_length;
  if (bytes.size() < view.size) return MessageStatus::need_more;
  const auto payload = bytes.subspan(header_bytes, view.header.payload_length);
  if (message_crc(bytes.first(header_bytes), payload) != view.header.crc) return MessageStatus::bad_crc;
  view.descriptor = payload.first(view.header.descriptor_length);
  view.plane = payload.subspan(view.header.descriptor_length);
  return MessageStatus::ok;
}

bool parse_descriptor(std::span<const std::byte> bytes, google::protobuf::MessageLite& descriptor) {
  return bytes.size() <= kMaxDescriptorBytes &&
         descriptor.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

std::int64_t utc_now_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace obliq::wire
