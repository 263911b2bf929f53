// Encodings of plane values, and windows of bins.
#include "proto/plane_coding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "proto/bin_window.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::wire::plane_coding_test {
namespace {

using Complex = std::complex<float>;

struct Coded {
  double scale = 0;
  std::vector<std::int16_t> integers;  ///< re, im, re, im
};

Coded coded(const std::vector<Complex>& values) {
  std::vector<std::byte> bytes(4 * values.size());
  Coded result;
  result.scale = encode_ci16(values, bytes);
  result.integers.resize(2 * values.size());
  std::memcpy(result.integers.data(), bytes.data(), bytes.size());
  return result;
}

/// The promise of PROTOCOL.md, computed in double from the wire's integers alone.
void expect_within_half_a_step(const std::vector<Complex>& values) {
  const Coded got = coded(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const auto& [value, integer] : {std::pair{values[i].real(), got.integers[2 * i]},
                                         std::pair{values[i].imag(), got.integers[2 * i + 1]}}) {
      // The last factor: two roundings in double, of numbers up to 32767 steps.
      const double error = std::fabs(integer * got.scale - static_cast<double>(value));
      ASSERT_LE(error, got.scale / 2 * (1 + 1e-10)) << value << " as " << integer << " x " << got.scale;
    }
  }
}

TEST(Ci16, TheLargestComponentIsFullScale) {
  const Coded got = coded({{0.5f, -2.0f}, {1.0f, 0.0f}});
  EXPECT_EQ(got.scale, 2.0 / 32767);
  EXPECT_EQ(got.integers, (std::vector<std::int16_t>{8192, -32767, 16384, 0}));
}

TEST(Ci16, EveryValueIsWithinHalfAStepAtAnyMagnitude) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (const float size : {1e-45f, 1e-40f, 1e-38f, 1e-12f, 1.0f, 1e20f, 1e37f}) {
    std::vector<Complex> values(1000);
    for (Complex& value : values) value = {std::ldexp(normal(random), -2) * size, normal(random) * size / 4};
    expect_within_half_a_step(values);
  }
  expect_within_half_a_step({{std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()}});
}

TEST(Ci16, AllZerosHaveScaleZeroAndComeBackAsZeros) {
  const Coded got = coded({{0.0f, -0.0f}, {0.0f, 0.0f}});
  EXPECT_EQ(got.scale, 0);
  EXPECT_EQ(got.integers, (std::vector<std::int16_t>{0, 0, 0, 0}));
}

TEST(Ci16, WhatIsNotFiniteStaysWithinTheIntegers) {
  const float infinity = std::numeric_limits<float>::infinity();
  const Coded got = coded({{std::nanf(""), infinity}, {-infinity, 3.0f}});
  EXPECT_EQ(got.scale, 3.0 / 32767);
  EXPECT_EQ(got.integers, (std::vector<std::int16_t>{0, 32767, -32767, 32767}));
  EXPECT_EQ(coded({{infinity, std::nanf("")}}).scale, 0);
}

WedgeBlock iq_block(std::uint32_t n_azimuth, std::uint32_t n_range) {
  WedgeBlock block;
  block.set_plane(IQ);
  block.set_n_azimuth(n_azimuth);
  block.set_n_range(n_range);
  return block;
}

TEST(PlaneCoding, DecodesWhatItEncodes) {
  std::vector<Complex> values(600);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {static_cast<float>(i % 7), -32767.0f};
  std::vector<std::byte> bytes(4 * values.size());
  WedgeBlock block = iq_block(20, 30);
  block.set_iq_encoding(CI16_LE);
  block.set_scale(encode_ci16(values, bytes));
  std::vector<std::byte> scratch;
  EXPECT_EQ(fault_of_block(block, bytes.size()), "");
  const auto plain = plain_values(block, bytes, scratch);
  ASSERT_TRUE(plain);
  ASSERT_EQ(plain->size(), values.size() * sizeof(Complex));
  EXPECT_EQ(std::memcmp(plain->data(), values.data(), plain->size()), 0) << "whole numbers of steps: exact";

  block.set_compression(ZSTD);
  block.set_plain_bytes(static_cast<std::uint32_t>(bytes.size()));
  const auto compressed = compress(bytes);
  ASSERT_FALSE(compressed.empty());
  EXPECT_EQ(fault_of_block(block, compressed.size()), "");
  const auto again = plain_values(block, compressed, scratch);
  ASSERT_TRUE(again);
  EXPECT_EQ(std::memcmp(again->data(), values.data(), again->size()), 0);
}

TEST(PlaneCoding, DamagedOrTruncatedCompressionIsNoticedAndStaysWithinItsBounds) {
  const std::vector<std::byte> plain(1000, std::byte{3});
  auto bytes = compress(plain);
  ASSERT_FALSE(bytes.empty());
  std::vector<std::byte> room(1000);
  EXPECT_TRUE(decompress(bytes, room));
  EXPECT_EQ(room, plain);
  std::vector<std::byte> smaller(999);
  EXPECT_FALSE(decompress(bytes, smaller)) << "more than the rectangle holds";
  std::vector<std::byte> larger(1001);
  EXPECT_FALSE(decompress(bytes, larger)) << "less than the rectangle holds";
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_FALSE(decompress(std::span(bytes).first(n), room)) << n;
  }
  bytes[0] ^= std::byte{1};
  EXPECT_FALSE(decompress(bytes, room));
}

TEST(PlaneCoding, NoiseIsNotCompressed) {
  std::mt19937 random(3);
  std::vector<std::byte> noise(5000);
  for (std::byte& value : noise) value = static_cast<std::byte>(random() & 0xFF);
  EXPECT_TRUE(compress(noise).empty());
}

TEST(PlaneCoding, ABlockThatCannotBeIsRefusedWithWhatWasFound) {
  WedgeBlock block = iq_block(2, 3);
  EXPECT_EQ(fault_of_block(block, 48), "");
  EXPECT_NE(fault_of_block(block, 47).find("found 47 bytes; allowed: 48"), std::string::npos);
  block.set_iq_encoding(CI16_LE);
  EXPECT_EQ(fault_of_block(block, 24), "");
  for (const double scale : {-1.0, 1e35, std::nan(""), HUGE_VAL}) {
    block.set_scale(scale);
    EXPECT_NE(fault_of_block(block, 24).find("scale"), std::string::npos) << scale;
  }
  block.set_scale(static_cast<double>(std::numeric_limits<float>::max()) / 32767);
  EXPECT_EQ(fault_of_block(block, 24), "");
  block.set_compression(ZSTD);
  EXPECT_NE(fault_of_block(block, 5), "") << "plain_bytes must be said, and be those of the rectangle";
  block.set_plain_bytes(24);
  EXPECT_EQ(fault_of_block(block, 5), "");
  block.set_compression(static_cast<CompressionKind>(9));
  EXPECT_NE(fault_of_block(block, 5), "");
  EXPECT_NE(fault_of_block(iq_block(1u << 31, 1u << 31), 0), "") << "beyond what a block may hold";
  EXPECT_NE(fault_of_block(iq_block(1, kMaxPlaneBytes / 8 + 1), kMaxPlaneBytes + 8), "");
}

TEST(BinWindow, KeepsEveryStepthBinFromItsFirst) {
  const BinRun run{3, 8, 3};  // bins 3, 6, 9 of 3 to 10
  EXPECT_EQ(run.kept(), 3u);
  EXPECT_EQ(run.index_from(0), 0u);
  EXPECT_EQ(run.index_from(3), 0u);
  EXPECT_EQ(run.index_from(4), 1u);
  EXPECT_EQ(run.index_from(9), 2u);
  EXPECT_EQ(run.index_from(10), 3u);
  EXPECT_EQ(run.index_from(1000), 3u);
}

TEST(BinWindow, IsCutToItsFrame) {
  EXPECT_EQ(cut_run({}, 20), (BinRun{0, 20, 1}));
  EXPECT_EQ(cut_run({5, 0, 2}, 20), (BinRun{5, 15, 2}));
  EXPECT_EQ(cut_run({5, 100, 2}, 20), (BinRun{5, 15, 2}));
  EXPECT_EQ(cut_run({19, 1, 7}, 20), (BinRun{19, 1, 7}));
  EXPECT_EQ(cut_run({20, 1, 1}, 20), std::nullopt);
  EXPECT_EQ(cut_run({0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF}, 20), std::nullopt);
}

}  // namespace
}  // namespace obliq::wire::plane_coding_test
