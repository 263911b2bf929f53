#pragma once
// The reference renderer: what every source of samples converges to (PAPER.md, definitions).
//
// It shares nothing with the pipeline but the world that it reads and the material functions. No rays, no
// Embree, no frustum: dense subdivision of the visible surface, by area.
//
// Method. The world is 2.5-D (a height grid and vertical prisms), so what an antenna sees in one vertical
// plane follows from one walk outwards. For each azimuth bin, at least `planes_per_bin` vertical planes stand
// at the middles of its parts. In each plane the surface is cut at every grid line, diagonal, footprint edge
// and where roof and ground cross; between two cuts it is one straight strip. From the nadir outwards
// (whatever r_min) the largest tangent of elevation so far, in long double, is the horizon; a strip is lit
// where it faces the antenna and rises above it, cut at the exact crossing. Inside a footprint the surface is
// the higher of ground and roofs; a wall is lit on its near side only. Known ground and buildings are solid
// all the way down: beyond a void, what lies behind the next known ground is in its shadow.
//
// Lit strips are cut at the exact range-bin edges, then into equal steps of at most step_m (step_m r / 200 m
// nearer than 200 m), and
//   P_bin = sum of K sigma(A_proj, theta) / r^4,  K = P_t G^2 lambda^2 / (4 pi)^3
// (Ulaby & Long 2014, sigma = sigma0 dA; Richards 2014, eq. 2.8) with the area element projected towards the
// antenna, A_proj = dA cos(theta). dA is d dphi dd / n_y on ground and roofs and d dphi dy / |n . e| on walls
// (d ground distance, phi azimuth, n unit normal, e horizontal direction of the plane); on both
//   A_proj = d dphi p dt / r,  cos(theta) = D / r
// where t is length along the strip, p the antenna's distance from the strip's line and D that from its plane
// in space: grazing ground and walls seen edge-on stay finite.
//
// Where the world has corners, a wall whose foot is lit returns with the lit ground before it, at the range
// of the foot (CornerIntegral, CornerTable): along the direction that the wall mirrors, in steps of step_m
// / 4.
//
// Planes never straddle a corner of a building: a bin is first split at the bearings of its buildings'
// corners, each stretch into as many equal parts as keep the planes' spacing. So a narrow building is never
// missed.
//
// Convergence. Along a strip the integrand is smooth and steps begin and end at every discontinuity: midpoint
// rule, error O(step_m^2). Across azimuth, midpoint rule as well: over ground, where a bin's power is
// continuous, O(planes_per_bin^-2); with buildings between that and O(planes_per_bin^-1), because a wall
// nearly in line with the sight changes its range bin within a fraction of the planes' spacing.
// tests/accuracy/truth/reference_order_test.cpp shows both, reference_test.cpp and reference_plates_test.cpp
// closed forms.
#include <algorithm>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "server/scene/materials.h"
#include "server/truth/sea_truth.h"
#include "terrain/base/parallel.h"
#include "terrain/world.h"

namespace obliq {

/// Where to look: plain numbers, no pipeline type.
struct ReferenceView {
  glm::dvec3 antenna_m{0.0};  ///< world
  double bearing_rad = 0;     ///< world angle of the sector's centre
  double sector_rad = 0;      ///< 0 < S <= 2 pi
  int azimuth_bins = 0;       ///< in the whole sector, clockwise
  double r_min_m = 0;         ///< slant ranges
  double r_max_m = 0;
  int range_bins = 0;
  double wavelength_m = 0;
  double power_w = 1;
  double gain = 1;                   ///< one-way power gain, linear
  bool range_normalisation = false;  ///< leaves 1 / r^4 out
  bool vertical = false;             ///< polarisation, of corners
  /// What a pattern in elevation does to power there and back, by the sine of elevation about the world's
  /// vertical and the world bearing. Empty: 1.
  std::function<double(double sin_elevation, double bearing_rad)> two_way_gain;
  bool keeps_facets = false;  ///< ReferenceBins::facets
  SeaView sea;
};

struct ReferenceSampling {
  int planes_per_bin = 32;  ///< at least; more where buildings have corners
  double step_m = 2;
  int threads = 0;  ///< 0 = all cores; the bits do not depend on it
};

/// How much of a building is seen. Solid angles within the requested azimuths and the range swath.
struct BuildingTruth {
  double visible_sr = 0;
  double unoccluded_sr = 0;  ///< standing on its ground alone: its own walls hide, nothing else does
  double largest_share = 0;  ///< of the power of any one bin, 0..1

  /// What other bins see of it.
  void add(const BuildingTruth& other) {
    visible_sr += other.visible_sr;
    unoccluded_sr += other.unoccluded_sr;
    largest_share = std::max(largest_share, other.largest_share);
  }
};

/// What a straight piece of the surface gives to one range bin.
struct FacetEcho {
  int range_bin = 0;
  bool of_building = false;
  double power_w = 0;
  double sin_elevation = 0;  ///< its mean, weighed by power
  double height_m = 0;       ///< above the antenna, likewise
};

/// Planes are [n_azimuth][n_range]. The truth of a bin is the sum of both.
struct ReferenceBins {
  int first_azimuth = 0;
  int n_azimuth = 0;
  int n_range = 0;
  std::vector<double> ground_w;
  std::vector<double> building_w;
  std::vector<BuildingTruth> buildings;        ///< [world.buildings.list.size()]
  std::vector<std::vector<FacetEcho>> facets;  ///< [n_azimuth] plane by plane; empty where not asked for
};

/// Integrates azimuth bins [first_azimuth, first_azimuth + n_azimuth). materials[id] for every material id in
/// the world. Throws InputError for impossible numbers, an antenna inside the ground or a building, and a
/// flat-plate material in use: its power depends on how finely a surface is cut, so it has no truth.
ReferenceBins integrate_reference(const World& world, const std::vector<Material>& materials,
                                  const ReferenceView& view, const ReferenceSampling& sampling,
                                  int first_azimuth, int n_azimuth, const Progress& progress = {});

}  // namespace obliq
