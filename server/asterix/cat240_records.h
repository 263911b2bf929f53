#pragma once
// The bytes of ASTERIX CAT 240, radar video (EUROCONTROL-SPEC-0149-240, edition 1.3): one record in a data
// block, one data block in a datagram. Big-endian.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace obliq::asterix {

/// The longest cell: CELL_DUR is a 32-bit number of femtoseconds.
double longest_cell_m();

/// Cell n is range bin n - 1, exactly; their starts differ by range_offset_m.
struct CellGeometry {
  std::uint32_t start_rg = 0;     ///< of range bin 0, in cells from the antenna
  std::uint32_t cell_dur_fs = 0;  ///< there and back
  double range_offset_m = 0;      ///< range that a display shows less the bin's own: half a cell at most

  bool operator==(const CellGeometry&) const = default;
};

/// Of range bins whose first begins at range_start_m. range_spacing_m: at most longest_cell_m().
CellGeometry cell_geometry(double range_start_m, double range_spacing_m);

/// A bearing in parts of a turn, 65536 of them; normalised.
std::uint16_t azimuth_units(double bearing_deg);

/// The edges of an azimuth bin. The right edge of a bin is the left edge of the next, to the bit.
struct AzimuthEdges {
  std::uint16_t start = 0;
  std::uint16_t end = 0;
};
AzimuthEdges azimuth_edges(double azimuth_start_deg, double azimuth_width_deg, std::uint32_t bin);

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
