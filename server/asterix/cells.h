#pragma once
// A frame's bins as the cells and azimuths of ASTERIX CAT 240 (EUROCONTROL-SPEC-0149-240, edition 1.3, item
// I240/041): cell n of a radial lies at (START_RG + n - 1) CELL_DUR c / 2, azimuths are 16-bit parts of a
// turn.
#include <cstdint>

namespace obliq::wire {
class FrameDescriptor;
}

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

}  // namespace obliq::asterix
