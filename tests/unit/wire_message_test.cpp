// Whole messages, and the example that PROTOCOL.md prints.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "proto/limits.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "proto/plane.h"

namespace obliq::wire {
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

TEST(Message, RandomBytesAreRefusedWithoutHarm) {
  std::mt19937 random(42);  // fixed seed: the same bytes every run
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes(random() % 300);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    // Half of them get past the magic and version, to reach the length checks.
    HeaderBytes head{};
    encode_header({}, head);
    if (round % 2 == 0) std::copy_n(head.begin(), std::min<std::size_t>(6, bytes.size()), bytes.begin());
    MessageView view;
    EXPECT_NE(decode_message(bytes, kMaxPayloadBytes, view), MessageStatus::ok);
    RenderOnce request;
    (void)parse_descriptor(bytes, request);  // any answer will do, as long as there is one
  }
}

TEST(Planes, HaveTheSizesOfTheTable) {
  EXPECT_EQ(bytes_per_bin(Plane::iq), 8u);
  EXPECT_EQ(bytes_per_bin(Plane::power), 8u);
  EXPECT_EQ(bytes_per_bin(Plane::count), 4u);
  EXPECT_EQ(bytes_per_bin(Plane::state), 1u);
  EXPECT_EQ(bytes_per_bin(Plane::video), 2u);
  EXPECT_FALSE(plane_from_number(5).has_value());
  EXPECT_FALSE(plane_from_number(-1).has_value());
}

// The hex dump between "```hex" and "```": offset, colon, bytes, then a bar and a comment.
Bytes example_of_the_protocol_document() {
  std::ifstream file(OBLIQ_PROTOCOL_DOCUMENT);
  Bytes bytes;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```hex";
      continue;
    }
    if (!inside) continue;
    std::istringstream rest(line.substr(line.find(':') + 1));
    std::string word;
    while (rest >> word && word != "|") bytes.push_back(static_cast<std::byte>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

TEST(ProtocolDocument, ItsExampleIsAMessageThatDecodesToWhatItSays) {
  const Bytes bytes = example_of_the_protocol_document();
  ASSERT_GT(bytes.size(), kHeaderBytes);
  MessageView view;
  ASSERT_EQ(decode_message(bytes, kMaxPayloadBytes, view), MessageStatus::ok);
  EXPECT_EQ(view.size, bytes.size());
  EXPECT_EQ(view.header.minor, kMinorVersion);
  EXPECT_EQ(view.header.type, MessageType::wedge_block);
  EXPECT_EQ(view.header.stream_id, 2u);
  EXPECT_EQ(view.header.sequence, 5u);
  EXPECT_EQ(view.header.utc_ns, 1767225600000000000);  // 2026-01-01T00:00Z
  WedgeBlock block;
  ASSERT_TRUE(parse_descriptor(view.descriptor, block));
  EXPECT_EQ(block.frame_id(), 1u);
  EXPECT_EQ(block.plane(), STATE);
  EXPECT_EQ(block.first_azimuth(), 8u);
  EXPECT_EQ(block.n_azimuth(), 2u);
  EXPECT_EQ(block.n_range(), 3u);
  EXPECT_EQ(block.wedge_index(), 1u);
  ASSERT_EQ(view.plane.size(), 6u);
  EXPECT_EQ(view.plane[0], std::byte{1});
  EXPECT_EQ(view.plane[5], std::byte{3});
}

TEST(ProtocolDocument, EncodingTheSameFieldsGivesTheSameBytes) {
  WedgeBlock block;
  block.set_frame_id(1);
  block.set_plane(STATE);
  block.set_first_azimuth(8);
  block.set_n_azimuth(2);
  block.set_n_range(3);
  block.set_wedge_index(1);
  const Bytes plane = {std::byte{1}, std::byte{1}, std::byte{2}, std::byte{1}, std::byte{0}, std::byte{3}};
  EXPECT_EQ(encode_message(MessageType::wedge_block, {2, 5, 1767225600000000000}, block, plane),
            example_of_the_protocol_document());
}

}  // namespace
}  // namespace obliq::wire
