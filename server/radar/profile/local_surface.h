#pragma once
// The scene's surface in one vertical plane through the antenna: ground, roofs and the walls that face the
// antenna, as straight pieces from the nadir outwards.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/scene/exact_hit.h"
#include "terrain/world.h"

namespace obliq {

/// A straight piece in the plane: ground distance d from the antenna, height h above it. A wall has both ends
/// at one distance, the lower one near.
struct PlanePiece {
  double near_d_m = 0, near_h_m = 0;
  double far_d_m = 0, far_h_m = 0;
  double near_slope = 0;  ///< tangents of the ends' elevations; -inf at the nadir
  double far_slope = 0;
  double normal_along = 0;  ///< components of the surface's normal: outwards in the plane,
  double normal_up = 1;     ///< and up; the third one is never needed, directions lie in the plane
  double normal_length2 = 1;
  std::uint32_t face = kNoFace;
  std::uint8_t material = 0;

  void set_ends(double near_d, double near_h, double far_d, double far_h) {
    near_d_m = near_d;
    near_h_m = near_h;
    far_d_m = far_d;
    far_h_m = far_h;
    near_slope = near_h / near_d;
    far_slope = far_h / far_d;
  }
  /// The part between two slopes, near_slope <= low <= high <= far_slope.
  PlanePiece between_slopes(double low, double high) const;
  /// The part that is nearer than a distance between its ends.
  PlanePiece nearer_than(double d_m) const;
};

/// A stretch of a plane over a building: inside from near to far, roof and walls of the highest one there.
struct RoofStretch {
  double near_m = 0, far_m = 0;
  double roof_y_m = 0;
  std::uint32_t building = 0;
  std::uint32_t near_wall = kNoFace;  ///< face at near_m
  double wall_normal_along = -1;      ///< its unit normal's component outwards in the plane
};

/// Appends the stretches of a building's footprint under the half-line from (x, z) along (sin, cos).
void add_roof_stretches(const Buildings& buildings, std::uint32_t building, double x_m, double z_m,
                        double sin_bearing, double cos_bearing, std::vector<RoofStretch>& stretches);

/// Sorts stretches by distance and leaves the highest roof where they overlap.
void make_disjoint(std::vector<RoofStretch>& stretches);

/// The surface in a plane, cell by cell of the ground grid. Keeps a reference to the world.
class PlaneSurface {
 public:
  PlaneSurface(const World& world, const glm::dvec3& antenna_m);

  /// Turns the plane. `stretches`: disjoint and sorted, kept by reference until the next turn.
  void aim(double sin_bearing, double cos_bearing, const std::vector<RoofStretch>& stretches);
  double sin_bearing() const { return sin_bearing_; }
  double cos_bearing() const { return cos_bearing_; }

  /// A grid cell and the distances at which the plane enters and leaves it.
  struct Cell {
    int i = 0;
    int j = 0;
    double from_m = 0;
    double to_m = 0;
    bool leaves_by_x = true;
    bool enters_by_x = true;
  };

  Cell cell_at(double d_m) const;
  Cell next_out(const Cell& cell) const;
  Cell next_in(const Cell& cell) const;
  bool known(const Cell& cell) const { return world_.grid.cell_known(cell.i, cell.j); }

  /// The pieces of a known cell, outwards; valid until the next call.
  const std::vector<PlanePiece>& pieces(const Cell& cell);

 private:
  Cell bounded(int i, int j) const;
  void add_triangle(const Cell& cell, bool upper, double d0, double d1);
  void add_ground(const PlanePiece& ground, double d0, double d1);
  void add_with_roofs(const PlanePiece& ground, double d0, double d1);
  void add_roof(const PlanePiece& ground, const RoofStretch& roof, double d0, double d1);
  void add_flat_roof(const RoofStretch& roof, double d0, double d1);

  const World& world_;
  const std::vector<RoofStretch>* stretches_ = nullptr;
  glm::dvec3 antenna_m_;
  double over_cell_m_;
  double start_u_, start_v_;  // the antenna, in cells from node (0, 0)
  double sin_bearing_ = 0, cos_bearing_ = 1;
  double per_x_ = 0, per_z_ = 1;    // ground distance a metre of x or z; infinite along the other axis
  double rate_u_ = 0, rate_v_ = 0;  // cells a metre of ground distance
  double ground_start_m_ = 0;       // the triangle at hand: height above the antenna at d = 0,
  double ground_rise_ = 0;          // and its rise along the plane
  std::vector<PlanePiece> pieces_;
};

}  // namespace obliq
