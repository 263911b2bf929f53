#include "tests/fuzz/input.h"

#include <google/protobuf/stubs/logging.h>

#include <cstdio>
#include <cstdlib>

#include "proto/limits.h"
#include "proto/message_header.h"

namespace obliq::fuzz {

QuietProtobuf::QuietProtobuf() { google::protobuf::SetLogHandler(nullptr); }

std::vector<std::byte> stream_of(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const bool mend = (input.u8() & 1) != 0;
  const auto given = input.rest();
  std::vector<std::byte> bytes(given.begin(), given.end());
  if (mend) mend_crcs(bytes);
  return bytes;
}

void mend_crcs(std::vector<std::byte>& bytes) {
  std::span<std::byte> left(bytes);
  while (left.size() >= wire::kHeaderBytes) {
    wire::MessageHeader header;
    const auto decoded =
        wire::decode_header(left.first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header);
    const std::size_t size = std::size_t{header.header_length} + header.payload_length;
    if (decoded != wire::HeaderStatus::ok || size > left.size()) {
      left = left.subspan(1);
      continue;
    }
    const std::uint32_t crc = wire::message_crc(left.first(header.header_length),
                                                left.subspan(header.header_length, header.payload_length));
    for (std::size_t i = 0; i < sizeof crc; ++i) {
      left[wire::kCrcOffset + i] = static_cast<std::byte>((crc >> (8 * i)) & 0xFF);
    }
    left = left.subspan(size);
  }
}

void broken(const char* what) {
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace obliq::fuzz
