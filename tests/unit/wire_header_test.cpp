// The header codec against hand-written bytes and published values.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string_view>

#include "proto/limits.h"
#include "proto/message_header.h"

namespace obliq::wire {
namespace {

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
      1,    1,    49,   0,                             // major, minor, type
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
}  // namespace obliq::wire
