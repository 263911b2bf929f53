#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "server/radar/echo/corners.h"
#include "server/radar/echo/echo_cells.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/buildings/sub_columns.h"

namespace obliq {

/// The corners of walls and ground in one azimuth bin (CornerTable), as sub-columns and strips see them. What
/// is before a wall's foot in the bin is worked out once, in the middle of the foot; how much of it is lit,
/// for each sub-column.
class CornerView {
 public:
  /// corners: null: none are wanted.
  CornerView(const ScenePlan& plan, const CornerTable* corners) : plan_(plan), table_(corners) {}

  bool wanted() const { return table_ != nullptr; }

  /// The sub-columns of a bin and the bearing of its centre.
  struct Columns {
    const SubColumns& all;
    SinCos centre;
  };
  /// Bits of the edges of a part that are walls that may stand square enough to the sight. near_m: how far
  /// ahead it begins; from, to: its tangents.
  std::uint64_t square_walls(const Columns& columns, const ConvexShape& part, float near_m, float from,
                             float to) const;

  struct Wall {
    std::uint32_t building;
    std::uint8_t material;
    std::uint32_t face;
  };
  /// Adds the corner of one of these, before the part hides anything.
  void see(const Columns& columns, const ConvexShape& part, int edge, const Wall& wall);

  /// What of a wall's foot lies in the bin. Distances are ground distances from the antenna, heights above
  /// it.
  struct Foot {
    std::uint32_t building, face;
    std::uint8_t material;  ///< of the building
    double normal_x, normal_z;
    SinCos bearing;  ///< of its middle
    double width_rad;
    double distance_m;  ///< of its middle
    double ground_m, roof_m;
    int plane;  ///< of the bin, whose profile has the shadows of the ground
  };
  /// Looks at the ground before a foot; false: it returns nothing, whatever is lit of it.
  bool begin(const Foot& foot, const NodeProfiles& nodes);
  /// And then: how far away its ends are.
  void spread(double left_m, double right_m);
  /// Whether buildings that hide all up to a slope leave all of the foot's light.
  bool is_whole(double shade) const {
    return foot_.distance_m * (-shade - down_) >= (-shade - rise_) * end_m_ && shade < -down_;
  }
  /// Adds what a part of that foot returns, from and to 0 to 1 across it, behind buildings that hide all up
  /// to the slope `shade`.
  void light(double from, double to, double shade);

  /// Gives the bin's to the sums: one scatterer a face, range bin and cell.
  void put(int profile, EchoCells& cells);

 private:
  static constexpr int kMostPieces = 2;  ///< of the strip that level ground before a wall would give

  /// A piece of the ground before the foot.
  struct Piece {
    double from_m, to_m;  ///< before it
    double weight;        ///< cross section without reflectivity, for a metre and the foot's whole width
    std::uint8_t ground;
  };
  /// Parts of an echo: sums by `weight`, a cross section without reflectivity.
  struct Part {
    std::uint32_t building, face;
    int range_bin;
    std::uint8_t material, ground;
    double weight, across, range_m;
    glm::dvec3 at_m;

    /// The same of parts of one echo.
    std::uint64_t echo() const {
      return static_cast<std::uint64_t>(face) << 32 | static_cast<std::uint32_t>(range_bin);
    }
  };
  bool lay_strip(double across, double along);
  double terrain_lit_m(const NodeProfiles& nodes, double most_m) const;
  double mean_lobe(std::uint8_t ground, const CornerSight& sight, const FootSlope& slope) const;
  void share_out(double from, double to, std::uint8_t ground, double weight);

  const ScenePlan& plan_;
  const CornerTable* table_;
  // Of the current foot.
  Foot foot_{};
  double down_ = 0, level_ = 0;  // tangent and cosine of its depression
  double rise_ = 0, across_ = 0;
  double end_m_ = 0;  // of the ground's own light before it
  double left_bin_ = 0, right_bin_ = 0;
  Piece pieces_[2 * kMostPieces];
  int n_pieces_ = 0;
  std::vector<Part> found_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  // of them: by echo, then as found
};

}  // namespace obliq
