#pragma once
// The bytes of ASTERIX CAT 240, radar video (EUROCONTROL-SPEC-0149-240, edition 1.3): one record in a data
// block, one data block in a datagram. Big-endian.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "server/asterix/cells.h"

namespace obliq::asterix {

using Bytes = std::vector<std::byte>;

/// I240/010.
struct Source {
  std::uint8_t sac = 0;
  std::uint8_t sic = 1;
};

/// I240/030 holds as many characters.
constexpr std::size_t kMostSummary = 255;

/// The largest datagram that an IPv4 packet carries.
constexpr std::size_t kMostDatagram = 65507;
/// The smallest that holds a video message with one block of cells.
std::size_t least_datagram();

/// A video summary message: 010, 000, 030, 140. What is not printable ASCII becomes '?', what is too long is
/// cut. Its time of day is 0 until stamp() sets it.
Bytes summary_message(const Source& source, std::string_view text);

/// One azimuth bin.
struct Radial {
  AzimuthEdges edges;
  std::span<const std::uint16_t> levels;  ///< [cells]
};

/// How radials are written.
struct VideoFormat {
  Source source;
  CellGeometry cells;
  int bits = 8;                     ///< of a level: 8 or 16
  std::size_t max_datagram = 1472;  ///< from least_datagram() to kMostDatagram
};

/// Appends a radial as video messages: 010, 000, 020, 041, 048, 049, 051 or 052, 140. One that does not fit
/// into a datagram becomes several with rising START_RG; the last block of each is filled up with 0.
/// message_index: of the first, raised by one for each. Their time of day is 0 until stamp() sets it.
void append_video(const VideoFormat& format, const Radial& radial, std::uint32_t& message_index,
                  std::vector<Bytes>& to);

/// Sets I240/140, the last item of either message: UTC since midnight in 1/128 s.
void stamp(Bytes& message, std::int64_t utc_ns);

}  // namespace obliq::asterix
