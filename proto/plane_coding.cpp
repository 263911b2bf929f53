#include "proto/plane_coding.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::wire {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

namespace {

constexpr double kFullScale = 32767;
/// Added and taken away, leaves the nearest integer (ties to even) of anything below 2^51.
constexpr double kRounding = 6755399441055744.0;
/// What full scale may be at most: the largest float.
constexpr double kLargestScale = static_cast<double>(std::numeric_limits<float>::max()) / kFullScale;
/// The fastest of zstd's levels that is not negative. A block is compressed while its radar waits.
constexpr int kZstdLevel = 1;

std::span<const float> components(std::span<const std::complex<float>> values) {
  // An array of complex is an array of pairs (C++ [complex.numbers]).
  return {reinterpret_cast<const float*>(values.data()), 2 * values.size()};
}

}  // namespace

std::optional<IqEncoding> iq_encoding_from_number(int number) {
  if (number != 0 && number != 1) return std::nullopt;
  return static_cast<IqEncoding>(number);
}
std::optional<Compression> compression_from_number(int number) {
  if (number != 0 && number != 1) return std::nullopt;
  return static_cast<Compression>(number);
}

const char* encoding_name(IqEncoding encoding) {
  return encoding == IqEncoding::ci16_le ? "ci16_le" : "cf32_le";
}
const char* compression_name(Compression compression) {
  return compression == Compression::zstd ? "zstd" : "none";
}

std::uint32_t coded_bytes_per_bin(Plane plane, IqEncoding encoding, int video_bits) {
  if (plane == Plane::video) return video_bits == 8 ? 1 : 2;
  return is_complex(plane) && encoding == IqEncoding::ci16_le ? 4 : bytes_per_bin(plane);
}

std::uint64_t values_of(const WedgeBlock& block) {
  const std::uint64_t rows = block.plane() == PULSES ? block.n_pulses() : block.n_azimuth();
  return rows * block.n_range();
}

int video_bits_of(const WedgeBlock& block, std::size_t payload_bytes) {
  const std::uint64_t bins = std::uint64_t{block.n_azimuth()} * block.n_range();
  const std::uint64_t bytes = block.compression() == ZSTD ? block.plain_bytes() : payload_bytes;
  return bytes == bins ? 8 : bytes == 2 * bins ? 16 : 0;
}

namespace {
constexpr int kTop8 = 254;  // levels above the floor
constexpr int kTop16 = 65534;
/// 0 stays 0; levels 1 to `top` + 1 are spread over 1 to `to_top` + 1.
constexpr int recoded(int level, int top, int to_top) {
  return level == 0 ? 0 : 1 + ((level - 1) * to_top + top / 2) / top;
}

}  // namespace

std::uint16_t video16_of(std::uint8_t level) {
  return static_cast<std::uint16_t>(recoded(level, kTop8, kTop16));
}
std::uint8_t video8_of(std::uint16_t level) {
  return static_cast<std::uint8_t>(recoded(level, kTop16, kTop8));
}

double encode_ci16(std::span<const std::complex<float>> values, std::span<std::byte> out, double step) {
  const auto in = components(values);
  float largest = 0;
  for (const float value : in) {
    const float size = std::fabs(value);
    if (size > largest && std::isfinite(size)) largest = size;
  }
  // In double neither the scale of the smallest float nor its inverse leaves the range of normal numbers.
  const bool in_steps = step > 0 && static_cast<double>(largest) < (kFullScale + 1.5) * step;
  const double scale = in_steps ? step : static_cast<double>(largest) / kFullScale;
  const double per_value = in_steps ? 1 / step : largest > 0 ? kFullScale / static_cast<double>(largest) : 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double steps = static_cast<double>(in[i]) * per_value;
    const double clamped =
        std::isnan(steps) ? 0 : std::clamp(steps, in_steps ? -kFullScale - 1 : -kFullScale, kFullScale);
    const auto integer = static_cast<std::int16_t>((clamped + kRounding) - kRounding);
    std::memcpy(out.data() + 2 * i, &integer, sizeof integer);
  }
  return scale;
}

void decode_ci16(std::span<const std::byte> bytes, double scale, std::span<std::complex<float>> values) {
  const auto component = [&](std::size_t i) {
    std::int16_t integer = 0;
    std::memcpy(&integer, bytes.data() + 2 * i, sizeof integer);
    return static_cast<float>(integer * scale);
  };
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {component(2 * i), component(2 * i + 1)};
}

std::vector<std::byte> compress(std::span<const std::byte> plain) {
  std::vector<std::byte> out(ZSTD_compressBound(plain.size()));
  const std::size_t n = ZSTD_compress(out.data(), out.size(), plain.data(), plain.size(), kZstdLevel);
  if (ZSTD_isError(n) || n >= plain.size()) return {};
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(n)};
}

bool decompress(std::span<const std::byte> bytes, std::span<std::byte> plain) {
  const std::size_t n = ZSTD_decompress(plain.data(), plain.size(), bytes.data(), bytes.size());
  return !ZSTD_isError(n) && n == plain.size();
}

std::string fault_of_block(const WedgeBlock& block, std::size_t payload_bytes) {
  const auto plane = plane_from_number(block.plane());
  const auto encoding = iq_encoding_from_number(block.iq_encoding());
  const auto compression = compression_from_number(block.compression());
  if (!plane)
    return "a data block of plane " + std::to_string(block.plane()) + "; allowed: " + numbered_planes();
  if (!encoding)
    return "a data block in encoding " + std::to_string(block.iq_encoding()) +
           "; allowed: 0 (cf32_le), 1 (ci16_le)";
  if (!compression)
    return "a data block in compression " + std::to_string(block.compression()) +
           "; allowed: 0 (none), 1 (zstd)";
  const std::uint64_t bins = values_of(block);
  const int video_bits = *plane == Plane::video ? video_bits_of(block, payload_bytes) : 0;
  const std::uint64_t bytes_a_bin = coded_bytes_per_bin(*plane, *encoding, video_bits);
  if (bins > kMaxPlaneBytes / bytes_a_bin)
    return "a data block of " + std::to_string(bins) + " bins; allowed: at most " +
           std::to_string(kMaxPlaneBytes / bytes_a_bin);
  const std::uint64_t bytes = bins * bytes_a_bin;
  const std::uint64_t found = *compression == Compression::none ? payload_bytes : block.plain_bytes();
  if (found != bytes)
    return "a data block has the wrong size: found " + std::to_string(found) +
           " bytes; allowed: " + std::to_string(bytes);
  if (*encoding == IqEncoding::ci16_le && !(block.scale() >= 0 && block.scale() <= kLargestScale))
    return "a data block's scale: found " + std::to_string(block.scale()) + "; allowed: from 0 to " +
           std::to_string(kLargestScale);
  return {};
}

std::optional<std::span<const std::byte>> plain_values(const WedgeBlock& block,
                                                       std::span<const std::byte> payload,
                                                       std::vector<std::byte>& scratch) {
  const bool integers = (block.plane() == IQ || block.plane() == PULSES) && block.iq_encoding() == CI16_LE;
  const std::size_t bins = values_of(block);
  const std::size_t decoded_bytes = integers ? bins * sizeof(std::complex<float>) : 0;
  const std::size_t plain_bytes = block.compression() == ZSTD ? block.plain_bytes() : 0;
  scratch.resize(decoded_bytes + plain_bytes);
  const std::span<std::byte> all(scratch);
  if (block.compression() == ZSTD) {
    const auto plain = all.subspan(decoded_bytes);
    if (!decompress(payload, plain)) return std::nullopt;
    payload = plain;
  }
  if (!integers) return payload;
  decode_ci16(payload, block.scale(), {reinterpret_cast<std::complex<float>*>(scratch.data()), bins});
  return all.first(decoded_bytes);
}

}  // namespace obliq::wire
