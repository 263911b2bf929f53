#pragma once
// How plane values are written into a data block: I&Q as floats or scaled integers, and any plane compressed.
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/plane.h"

namespace obliq::wire {

class WedgeBlock;

/// The numbers are those of the protobuf enumerations.
enum class IqEncoding : std::uint8_t { cf32_le = 0, ci16_le = 1 };
enum class Compression : std::uint8_t { none = 0, zstd = 1 };

/// Nothing for a number that is none of them.
std::optional<IqEncoding> iq_encoding_from_number(int number);
std::optional<Compression> compression_from_number(int number);

/// The names in Welcome.encodings and on command lines.
const char* encoding_name(IqEncoding encoding);
const char* compression_name(Compression compression);

/// Bytes per bin before compression: as bytes_per_bin, but 4 for iq and pulses as ci16_le and 1 for video of
/// 8 bits.
std::uint32_t coded_bytes_per_bin(Plane plane, IqEncoding encoding, int video_bits = 16);

/// How many values a block holds: of its bins, or of pulses.
std::uint64_t values_of(const WedgeBlock& block);

/// Bits of a block's video values, 8 or 16, by its size; 0: of no such block.
int video_bits_of(const WedgeBlock& block, std::size_t payload_bytes);

/// Levels of 8 bits on the scale of 16, and back: 0 and the ends stay what they are.
std::uint16_t video16_of(std::uint8_t level);
std::uint8_t video8_of(std::uint16_t level);

/// Writes 2 x int16 per value, little-endian, and returns the scale: value = integer x scale. The largest
/// component becomes 32767, so each is off by at most scale / 2. All zero: scale 0. What is not finite is
/// written as 0 (NaN) or full scale (infinity). `out` holds 4 bytes per value.
/// step: what the components are whole multiples of, at most 32768 times: it becomes the scale, and nothing
/// is lost. 0: of nothing.
double encode_ci16(std::span<const std::complex<float>> values, std::span<std::byte> out, double step = 0);
void decode_ci16(std::span<const std::byte> bytes, double scale, std::span<std::complex<float>> values);

/// Empty when the result would not be smaller. The same bytes always for one version of libzstd.
std::vector<std::byte> compress(std::span<const std::byte> plain);
/// False when the bytes are damaged or do not give exactly as much as `plain` holds; nothing is written
/// beyond it.
[[nodiscard]] bool decompress(std::span<const std::byte> bytes, std::span<std::byte> plain);

/// What a block says about its values, checked: the plane, the rectangle and the coding are possible and
/// within the limits, and `payload` has the right length (uncompressed ones). Empty, or what is wrong.
std::string fault_of_block(const WedgeBlock& block, std::size_t payload_bytes);

/// The values of a block without fault, as its plane's own type: the payload itself, or decoded into
/// `scratch`. Nothing when the payload is damaged.
std::optional<std::span<const std::byte>> plain_values(const WedgeBlock& block,
                                                       std::span<const std::byte> payload,
                                                       std::vector<std::byte>& scratch);

}  // namespace obliq::wire
