#pragma once
#include <utility>
#include <vector>

#include "server/truth/corner_integral.h"
#include "server/truth/sighted_buildings.h"
#include "server/truth/strip_integral.h"

namespace obliq {

/// What the antenna sees in one vertical plane.
struct PlaneStrips {
  std::vector<Strip> lit;     ///< outwards
  std::vector<LitFoot> feet;  ///< of walls, where the world has corners
  std::vector<Strip> alone;   ///< of each building as if nothing but it and the ground under it were there
};

/// Walks vertical planes outwards from the antenna. Holds buffers: one walker a thread.
class PlaneWalk {
 public:
  PlaneWalk(const World& world, const SightedBuildings& sighted, const ReferenceView& view);

  /// Replaces `strips` by those of the plane at this world bearing, which lies in this azimuth bin.
  void walk(double bearing_rad, int azimuth_bin, PlaneStrips& strips);

 private:
  /// A building that the plane crosses.
  struct Crossed {
    std::uint32_t building;
    long double roof_h, base_h;
    std::uint8_t material;
    bool inside;
    ExactHorizon own;  ///< of the building alone
  };
  /// Ground of one interval: h = h0 + rise (d - d0).
  struct GroundLine {
    bool known = false;  ///< false: no ground
    long double d0 = 0, h0 = 0, rise = 0;
    double plane_distance_m = 0;
    std::uint8_t material = 0;
    double raster_gamma = 1;
    long double at(long double d) const { return h0 + rise * (d - d0); }
  };
  /// A building whose footprint the plane enters: index into crossed_, and the wall.
  struct Entered {
    std::size_t owner;
    double cos_to_plane;
    double normal_x, normal_z;
  };
  /// What a strip belongs to.
  struct Surface {
    double plane_distance_m;
    std::int32_t building;
    std::uint8_t material;
  };

  void find_buildings(int azimuth_bin);
  void find_cuts();
  void cut_lines(long double start, long double rate, int last);
  GroundLine ground_between(long double from, long double to) const;
  void cross_outlines(long double d, const GroundLine& ground, PlaneStrips& strips);
  void walls(long double d, const GroundLine& ground, PlaneStrips& strips);
  void foot(long double d, const GroundLine& ground, const Entered& entered, PlaneStrips& strips) const;
  void surface(long double from, long double to, const GroundLine& ground, std::vector<Strip>& lit);
  void roof(const Crossed& crossed, ExactHorizon& horizon, long double from, long double to,
            std::vector<Strip>& out);

  AzimuthPlane plane_{};
  const World& world_;
  const SightedBuildings& sighted_;
  const glm::dvec3 antenna_m_;
  const double reach_m_;
  const long double start_u_, start_v_;  // the antenna, in cells from node (0, 0)
  long double rate_u_ = 0, rate_v_ = 0;  // cells a metre of ground distance

  std::vector<long double> cuts_;
  std::vector<OutlineCrossing> crossings_;
  std::size_t next_crossing_ = 0;
  std::vector<Crossed> crossed_;
  std::vector<Entered> entered_;
  ExactHorizon horizon_;
  bool top_known_ = false;  // the surface's height just before the current distance
  long double top_h_ = 0;
};

}  // namespace obliq
