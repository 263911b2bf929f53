// Whole messages, and the example that PROTOCOL.md prints.
// The header codec against hand-written bytes and published values.
#include "proto/message_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>

#include "proto/limits.h"
#include "proto/message_header.h"
#include "proto/obliq.pb.h"
#include "proto/plane.h"
#include "tests/support/page_block.h"

namespace obliq::wire::message_codec_test {
namespace {

Bytes sample_message(std::size_t plane_bytes = 12) {
  WedgeBlock block;
  block.set_frame_id(7);
  block.set_plane(COUNT);
  const Bytes plane(plane_bytes, std::byte{0x5A});
  return encode_message(MessageType::wedge_block, {3, 9, 1234}, block, plane);
}

TEST(Message, ComesBackAsItWent) {
  const Bytes bytes = sample_message();
  MessageView view;
  ASSERT_EQ(decode_message(bytes, kMaxPayloadBytes, view), MessageStatus::ok);
  EXPECT_EQ(view.size, bytes.size());
  EXPECT_EQ(view.header.type, MessageType::wedge_block);
  EXPECT_EQ(view.header.stream_id, 3u);
  EXPECT_EQ(view.header.sequence, 9u);
  EXPECT_EQ(view.header.utc_ns, 1234);
  ASSERT_EQ(view.plane.size(), 12u);
  EXPECT_EQ(view.plane[11], std::byte{0x5A});
  WedgeBlock block;
  ASSERT_TRUE(parse_descriptor(view.descriptor, block));
  EXPECT_EQ(block.frame_id(), 7u);
  EXPECT_EQ(block.plane(), COUNT);
}

TEST(Message, IsIncompleteUntilItsLastByte) {
  const Bytes bytes = sample_message();
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    MessageView view;
    EXPECT_EQ(decode_message(std::span(bytes).first(n), kMaxPayloadBytes, view), MessageStatus::need_more);
  }
}

TEST(Message, AnyFlippedBitIsNoticed) {
  const Bytes good = sample_message();
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    MessageView view;
    EXPECT_NE(decode_message(bad, kMaxPayloadBytes, view), MessageStatus::ok) << "bit " << bit;
  }
}

TEST(Message, WithALongerHeaderOfALaterMinorVersionIsRead) {
  // A version 1.2 header: eight more bytes, under the CRC like the rest.
  const Bytes now = sample_message();
  Bytes later(now.begin(), now.begin() + kHeaderBytes);
  later.insert(later.end(), 8, std::byte{0xEE});
  MessageHeader header;
  ASSERT_EQ(decode_header(std::span<const std::byte>(later).first<kHeaderBytes>(), kMaxPayloadBytes, header),
            HeaderStatus::ok);
  header.minor = kMinorVersion + 1;
  header.header_length = kHeaderBytes + 8;
  encode_header(header, std::span(later).first<kHeaderBytes>());
  const auto payload = std::span(now).subspan(kHeaderBytes);
  header.crc = message_crc(later, payload);
  encode_header(header, std::span(later).first<kHeaderBytes>());
  later.insert(later.end(), payload.begin(), payload.end());

  MessageView view;
  ASSERT_EQ(decode_message(later, kMaxPayloadBytes, view), MessageStatus::ok);
  EXPECT_EQ(view.plane.size(), 12u);
  WedgeBlock block;
  EXPECT_TRUE(parse_descriptor(view.descriptor, block));
  EXPECT_EQ(block.frame_id(), 7u);
}

TEST(Message, BeyondTheLimitsIsNotEncoded) {
  EXPECT_FALSE(sample_message(kMaxPlaneBytes).empty());
  EXPECT_TRUE(sample_message(kMaxPlaneBytes + 1).empty());
}

TEST(Planes, HaveTheSizesOfTheTable) {
  EXPECT_EQ(bytes_per_bin(Plane::iq), 8u);
  EXPECT_EQ(bytes_per_bin(Plane::power), 8u);
  EXPECT_EQ(bytes_per_bin(Plane::count), 4u);
  EXPECT_EQ(bytes_per_bin(Plane::state), 1u);
  EXPECT_EQ(bytes_per_bin(Plane::video), 2u);
  EXPECT_EQ(bytes_per_bin(Plane::pulses), 8u);
  EXPECT_EQ(plane_from_number(5), Plane::pulses);
  EXPECT_FALSE(plane_from_number(kPlanes).has_value());
  EXPECT_FALSE(plane_from_number(-1).has_value());
}

TEST(ProtocolDocument, ItsExampleIsTheMessageOfTheFieldsThatItNames) {
  WedgeBlock block;
  block.set_frame_id(1);
  block.set_plane(STATE);
  block.set_first_azimuth(8);
  block.set_n_azimuth(2);
  block.set_n_range(3);
  block.set_wedge_index(1);
  const Bytes plane = {std::byte{1}, std::byte{1}, std::byte{2}, std::byte{1}, std::byte{0}, std::byte{3}};
  EXPECT_EQ(encode_message(MessageType::wedge_block, {2, 5, 1767225600000000000}, block, plane),
            test::bytes_of_block(OBLIQ_PROTOCOL_DOCUMENT, "hex"));
}

std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

TEST(Crc32c, GivesTheCheckValueOfTheCatalogue) { EXPECT_EQ(crc32c(as_bytes("123456789")), 0xE3069283u); }

TEST(Crc32c, GivesTheValuesOfRfc3720ForThirtyTwoBytes) {
  std::array<std::byte, 32> bytes{};
  EXPECT_EQ(crc32c(bytes), 0x8A9136AAu);
  bytes.fill(std::byte{0xFF});
  EXPECT_EQ(crc32c(bytes), 0x62A8AB43u);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
  EXPECT_EQ(crc32c(bytes), 0x46DD794Eu);
}

TEST(Crc32c, ContinuesOverParts) {
  EXPECT_EQ(crc32c(as_bytes("6789"), crc32c(as_bytes("12345"))), 0xE3069283u);
  EXPECT_EQ(crc32c({}), 0u);
}

MessageHeader sample_header() {
  MessageHeader header;
  header.type = MessageType::wedge_block;
  header.flags = 0x0102;
  header.payload_length = 0x00030201;
  header.descriptor_length = 0x00020304;
  header.stream_id = 0xA1A2A3A4;
  header.sequence = 0x0102030405060708;
  header.utc_ns = -2;
  header.crc = 0xC1C2C3C4;
  return header;
}

TEST(MessageHeader, LaysItsFieldsOutLittleEndianInTheDocumentedOrder) {
  HeaderBytes bytes{};
  encode_header(sample_header(), bytes);
  constexpr std::array<unsigned char, kHeaderBytes> kExpected = {
      'O',  'B',  'L',  'Q',                           // magic
      1,    2,    49,   0,                             // major, minor, type
      0x02, 0x01, 48,   0,                             // flags, header length
      0x01, 0x02, 0x03, 0x00, 0x04, 0x03, 0x02, 0x00,  // payload and descriptor length
      0xA4, 0xA3, 0xA2, 0xA1,                          // stream id
      8,    7,    6,    5,    4,    3,    2,    1,     // sequence
      0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,  // UTC
      0xC4, 0xC3, 0xC2, 0xC1, 0,    0,    0,    0};    // CRC, reserved
  for (std::size_t i = 0; i < kHeaderBytes; ++i) {
    EXPECT_EQ(std::to_integer<int>(bytes[i]), int{kExpected[i]}) << "byte " << i;
  }
}

TEST(MessageHeader, ComesBackAsItWent) {
  HeaderBytes bytes{};
  encode_header(sample_header(), bytes);
  MessageHeader back;
  ASSERT_EQ(decode_header(bytes, kMaxPayloadBytes, back), HeaderStatus::ok);
  const MessageHeader sent = sample_header();
  EXPECT_EQ(back.type, sent.type);
  EXPECT_EQ(back.flags, sent.flags);
  EXPECT_EQ(back.payload_length, sent.payload_length);
  EXPECT_EQ(back.descriptor_length, sent.descriptor_length);
  EXPECT_EQ(back.stream_id, sent.stream_id);
  EXPECT_EQ(back.sequence, sent.sequence);
  EXPECT_EQ(back.utc_ns, sent.utc_ns);
  EXPECT_EQ(back.crc, sent.crc);
}

HeaderStatus decode_changed(std::size_t offset, unsigned char value) {
  HeaderBytes bytes{};
  encode_header(sample_header(), bytes);
  bytes[offset] = static_cast<std::byte>(value);
  MessageHeader header;
  return decode_header(bytes, kMaxPayloadBytes, header);
}

TEST(MessageHeader, RefusesForeignBytesOtherMajorsAndImpossibleLengths) {
  EXPECT_EQ(decode_changed(0, 'G'), HeaderStatus::bad_magic);
  EXPECT_EQ(decode_changed(4, 2), HeaderStatus::version_mismatch);
  EXPECT_EQ(decode_changed(4, 0), HeaderStatus::version_mismatch);
  EXPECT_EQ(decode_changed(10, 47), HeaderStatus::bad_length) << "header shorter than version 1.0";
  EXPECT_EQ(decode_changed(11, 2), HeaderStatus::bad_length) << "header of 512 + 48 bytes";
  EXPECT_EQ(decode_changed(15, 0x7F), HeaderStatus::bad_length) << "payload of 2 GB";
  EXPECT_EQ(decode_changed(15, 0xFF), HeaderStatus::bad_length) << "payload of 4 GB";
  EXPECT_EQ(decode_changed(14, 0x01), HeaderStatus::bad_length) << "descriptor longer than payload";
}

TEST(MessageHeader, AcceptsALaterMinorVersionWithALongerHeader) {
  EXPECT_EQ(decode_changed(5, 9), HeaderStatus::ok);
  EXPECT_EQ(decode_changed(10, 64), HeaderStatus::ok);
  EXPECT_EQ(decode_changed(6, 0xEE), HeaderStatus::ok) << "an unknown type is the caller's to skip";
}

TEST(MessageHeader, SaysWhatWasFoundAndWhatIsAllowed) {
  MessageHeader header;
  header.major = 7;
  header.minor = 3;
  EXPECT_NE(describe(HeaderStatus::version_mismatch, header, 10).find("found 7.3; allowed: 1.x"),
            std::string::npos);
  header.payload_length = 4000000000u;
  const std::string text = describe(HeaderStatus::bad_length, header, 65536);
  EXPECT_NE(text.find("4000000000"), std::string::npos);
  EXPECT_NE(text.find("65536"), std::string::npos);
}

}  // namespace
}  // namespace obliq::wire::message_codec_test
