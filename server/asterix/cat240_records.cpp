#include "server/asterix/cat240_records.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/base/units.h"

namespace obliq::asterix {
namespace {

constexpr double kTurnUnits = 65536;  // I240/041: least significant bit 360 / 2^16 degrees
// There and back: a cell of d metres lasts 2 d / c.
constexpr double kFemtosecondsPerMetre = 2e15 / kSpeedOfLight_m_s;

constexpr std::uint8_t kCategory = 240;
constexpr std::uint8_t kSummaryMessage = 1;  // I240/000
constexpr std::uint8_t kVideoMessage = 2;
constexpr std::uint8_t kResolutionOf8Bits = 4;  // I240/048, RES
constexpr std::uint8_t kResolutionOf16Bits = 5;

// Field specifications: a bit for each item of the edition's user application profile, in its order 010, 000,
// 020, 030, 040, 041, 048, FX, 049, 050, 051, 052, 140.
constexpr std::uint16_t kSummaryItems = 0xD108;      // 010 000 030, 140
constexpr std::uint16_t kMediumVideoItems = 0xE7A8;  // 010 000 020 041 048, 049 051 140
constexpr std::uint16_t kHighVideoItems = 0xE798;    // the same with 052 in place of 051

// Octets of a video message besides its cells: category and length, FSPEC, 010, 000, 020, 041, 048, 049, the
// repetition factor of 051, 140.
constexpr std::size_t kVideoOverhead = 3 + 2 + 2 + 1 + 4 + 12 + 2 + 5 + 1 + 3;
constexpr std::size_t kMediumBlock = 64;  // I240/051
constexpr std::size_t kHighBlock = 256;   // I240/052
constexpr std::size_t kMostBlocks = 255;  // a repetition factor has one octet

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::size_t kTimeOctets = 3;

void put(Bytes& to, std::uint64_t value, int octets) {
  for (int octet = octets - 1; octet >= 0; --octet)
    to.push_back(static_cast<std::byte>(value >> (8 * octet)));
}

/// Everything up to what differs between the messages.
Bytes begin(std::uint16_t items, const Source& source, std::uint8_t message, std::size_t octets) {
  Bytes bytes;
  bytes.reserve(octets);
  put(bytes, kCategory, 1);
  put(bytes, octets, 2);
  put(bytes, items, 2);
  put(bytes, source.sac, 1);
  put(bytes, source.sic, 1);
  put(bytes, message, 1);
  return bytes;
}

/// How the octets of a radial are laid out.
struct Blocks {
  std::uint16_t items = kMediumVideoItems;
  std::size_t octets = kMediumBlock;
  std::size_t most = 1;  ///< in a message
};
Blocks blocks_for(std::size_t radial_octets, std::size_t max_datagram) {
  const std::size_t room = max_datagram - kVideoOverhead;
  const bool high = radial_octets > kMostBlocks * kMediumBlock && room / kMediumBlock > kMostBlocks;
  Blocks blocks;
  if (high) blocks = {kHighVideoItems, kHighBlock, 1};
  blocks.most = std::min(kMostBlocks, room / blocks.octets);
  return blocks;
}

}  // namespace

std::size_t least_datagram() { return kVideoOverhead + kMediumBlock; }

Bytes summary_message(const Source& source, std::string_view text) {
  text = text.substr(0, kMostSummary);
  // Category and length, FSPEC, 010, 000, the repetition factor of 030, its characters, 140.
  Bytes bytes = begin(kSummaryItems, source, kSummaryMessage, 3 + 2 + 2 + 1 + 1 + text.size() + kTimeOctets);
  put(bytes, text.size(), 1);
  for (const char c : text) put(bytes, static_cast<std::uint8_t>(c >= ' ' && c <= '~' ? c : '?'), 1);
  put(bytes, 0, kTimeOctets);
  return bytes;
}

void append_video(const VideoFormat& format, const Radial& radial, std::uint32_t& message_index,
                  std::vector<Bytes>& to) {
  const std::size_t cell_octets = format.bits == 16 ? 2 : 1;
  const Blocks blocks = blocks_for(radial.levels.size() * cell_octets, format.max_datagram);
  const std::size_t most_cells = blocks.most * blocks.octets / cell_octets;
  for (std::size_t first = 0; first < radial.levels.size(); first += most_cells) {
    const auto levels = radial.levels.subspan(first, std::min(most_cells, radial.levels.size() - first));
    const std::size_t valid = levels.size() * cell_octets;
    const std::size_t n_blocks = (valid + blocks.octets - 1) / blocks.octets;
    Bytes bytes =
        begin(blocks.items, format.source, kVideoMessage, kVideoOverhead + n_blocks * blocks.octets);
    put(bytes, message_index++, 4);                // 020
    put(bytes, radial.edges.start, 2);             // 041: START_AZ
    put(bytes, radial.edges.end, 2);               // END_AZ
    put(bytes, format.cells.start_rg + first, 4);  // START_RG
    put(bytes, format.cells.cell_dur_fs, 4);       // CELL_DUR
    put(bytes, 0, 1);                              // 048: C, not compressed
    put(bytes, format.bits == 16 ? kResolutionOf16Bits : kResolutionOf8Bits, 1);
    put(bytes, valid, 2);          // 049: NB_VB
    put(bytes, levels.size(), 3);  // NB_CELLS
    put(bytes, n_blocks, 1);       // 051 or 052
    const std::size_t cells_at = bytes.size();
    bytes.resize(cells_at + n_blocks * blocks.octets);
    std::byte* cell = bytes.data() + cells_at;
    for (const std::uint16_t level : levels) {
      if (cell_octets == 2) *cell++ = static_cast<std::byte>(level >> 8);
      *cell++ = static_cast<std::byte>(level);
    }
    put(bytes, 0, kTimeOctets);  // 140
    to.push_back(std::move(bytes));
  }
}

void stamp(Bytes& message, std::int64_t utc_ns) {
  const std::int64_t of_day_ns = ((utc_ns % kDay_ns) + kDay_ns) % kDay_ns;
  const auto ticks = static_cast<std::uint64_t>(of_day_ns) * 128 / 1'000'000'000;
  for (std::size_t octet = 0; octet < kTimeOctets; ++octet)
    message[message.size() - 1 - octet] = static_cast<std::byte>(ticks >> (8 * octet));
}

double longest_cell_m() { return std::numeric_limits<std::uint32_t>::max() / kFemtosecondsPerMetre; }

CellGeometry cell_geometry(double range_start_m, double range_spacing_m) {
  CellGeometry geometry;
  geometry.cell_dur_fs = static_cast<std::uint32_t>(std::llround(kFemtosecondsPerMetre * range_spacing_m));
  geometry.start_rg = static_cast<std::uint32_t>(std::llround(range_start_m / range_spacing_m));
  geometry.range_offset_m = geometry.start_rg * range_spacing_m - range_start_m;
  return geometry;
}

std::uint16_t azimuth_units(double bearing_deg) {
  const double turns = bearing_deg / 360;
  const auto units = std::llround(kTurnUnits * (turns - std::floor(turns)));
  return static_cast<std::uint16_t>(units % static_cast<long long>(kTurnUnits));
}

AzimuthEdges azimuth_edges(double azimuth_start_deg, double azimuth_width_deg, std::uint32_t bin) {
  const auto edge = [&](double bins) { return azimuth_units(azimuth_start_deg + bins * azimuth_width_deg); };
  return {edge(bin), edge(bin + 1.0)};
}

}  // namespace obliq::asterix
