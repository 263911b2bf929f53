#pragma once
#include <cstdint>

#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Profiles of an azimuth bin's planes, bare ground alone, at nodes a fixed ground distance apart: node k
/// stands at (k + kFirstNode) node_m. [planes][stride] of everything.
struct NodeProfiles {
  static constexpr float kFirstNode = 0.001F;  ///< a slope straight below the antenna would be infinite
  int planes;
  int stride;   ///< a multiple of 16
  int n_nodes;  ///< of a profile that are filled in
  float node_m;
  float* horizon;    ///< greatest slope (height above the antenna over ground distance) up to a node
  float* clearance;  ///< that less the node's own slope; 0 over unknown ground
  float* range_bin;  ///< slant range of the node's distance on the horizon, in bins from r_min
  float* hidden;     ///< of the visible slope from a node to the next, what buildings hide
  float* sine;       ///< of the horizon's elevation; null: not wanted
};

/// The ground as floats see it: in cells from node (0, 0), heights above the antenna.
struct GroundOfBin {
  const float* y_m;
  int nx, nz;
  float antenna_y_m;
  float start_u, start_v;      ///< the antenna
  float forward_u, forward_v;  ///< cells a metre ahead, along the bin's centre
  float right_u, right_v;      ///< and to its right
};

/// Sub-columns of an azimuth bin: lanes that see its buildings one after the other by distance. Directions
/// are tangents of the azimuth from the bin's centre.
struct SubColumns {
  static constexpr int kLeastLanes = 16;
  static constexpr int kMostLanes = 32;  ///< that see at a time
  GroundOfBin ground;
  NodeProfiles nodes;
  int n;        ///< a multiple of kLeastLanes
  float left;   ///< edge of the first
  float width;  ///< of one
  float width_rad;
  float* roofs;            ///< [n] greatest slope of what buildings hide so far; of a part, in part
  float* shades;           ///< [n] the same of those that cover half of one at least, whole; null: not wanted
  const float* per_plane;  ///< [planes] 1 / sub-columns of the plane
  float r_min_m, range_spacing_m;
  int n_range;
};

/// The plane that lies nearest to sub-column `number` of n.
inline int plane_of(int number, int planes, int n) { return (2 * number + 1) * planes / (2 * n); }

/// A convex part of a building in the bin's axes: corners counter-clockwise, the first again at the end.
struct ConvexShape {
  static constexpr int kMost = 40;  ///< kMostPartCorners and one that clipping adds, in eights
  int n;
  float right_m[kMost + 1];
  float ahead_m[kMost + 1];  ///< positive
  float tangent[kMost + 1];
  std::uint64_t walls;   ///< a bit for each edge: others are inner edges
  float roof_m, base_m;  ///< above the antenna
};

/// What a bin's sub-columns see of a part: of each wall, and of the roof, what falls into each range bin.
struct PartEchoes {
  static constexpr int kMost = 2048;
  static constexpr int kRoof = -1;
  struct Echo {
    int bin;
    int edge;  ///< of the wall; kRoof
    float solid_angle_sr;
    float range_m;     ///< in its bin
    float middle_m;    ///< of the whole wall or roof
    float tangent_sr;  ///< mean tangent x solid angle
  };
  int n;
  Echo echo[kMost];
};

/// Fills in the profile of one plane: its direction in cells a metre.
OBLIQ_KERNEL(void, profile_nodes, const SubColumns&, int plane, float rate_u, float rate_v);

/// Shows a part to sub-columns [first, first + count), at most kMostLanes, and to some behind them: appends
/// what they see, and takes its shadow from the nodes and the sub-columns behind it.
OBLIQ_KERNEL(void, see_part, const SubColumns&, const ConvexShape&, int first, int count, PartEchoes&);

}  // namespace obliq
