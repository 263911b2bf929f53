#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/echo/corners.h"
#include "server/radar/echo/echo_cells.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/sub_columns.h"

namespace obliq {

/// The corners of walls and ground in one azimuth bin (CornerTable), from pieces of walls' feet that
/// sub-columns and strips see. The ground before a foot is taken for even: that half way along what takes
/// part.
class CornerView {
 public:
  /// corners: null: none are wanted.
  CornerView(const ScenePlan& plan, const CornerTable* corners) : plan_(plan), table_(corners) {}

  bool wanted() const { return table_ != nullptr; }

  /// A piece of a wall's foot, so narrow that its light is one. Distances are ground distances from the
  /// antenna, heights above it.
  struct Foot {
    std::uint32_t face;
    std::uint8_t material;  ///< of the building
    double normal_x, normal_z;
    SinCos bearing;  ///< of its middle
    double width_rad;
    double distance_m;       ///< of its middle
    double left_m, right_m;  ///< of its ends
    double ground_m, roof_m;
    double shade;  ///< greatest slope of what buildings before it hide
    int plane;     ///< of the bin, whose profile has the shadows of the ground
  };

  /// The sub-columns of a bin and the bearing of its centre.
  struct Columns {
    const SubColumns& all;
    SinCos centre;
  };
  /// Adds the corners of a part's walls (CornerView::add), before it hides anything. faces: of its edges.
  void see(const Columns& columns, const ConvexShape& part, const std::uint32_t* faces,
           std::uint8_t material);

  /// Adds what the foot and the lit ground before it return.
  void add(const Foot& foot, const NodeProfiles& nodes);

  /// Gives the bin's to the sums: one scatterer a face, range bin and cell.
  void put(int profile, EchoCells& cells);

 private:
  void see_foot(const Columns& columns, const ConvexShape& part, int edge, int column, Foot foot);
  /// Parts of an echo: sums by `weight`, a cross section without reflectivity.
  struct Part {
    std::uint32_t face;
    int range_bin;
    std::uint8_t material, ground;
    double weight, across, range_m;
    glm::dvec3 at_m;
  };
  static double lit_m(const Foot& foot, const NodeProfiles& nodes, double most_m);
  double mean_lobe(const Foot& foot, std::uint8_t ground, const CornerSight& sight,
                   const FootSlope& slope) const;
  void share_out(const Foot& foot, Part part);

  const ScenePlan& plan_;
  const CornerTable* table_;
  std::vector<Part> found_;
};

}  // namespace obliq
