#pragma once
// Which part of the world a scene is built for, and when the radars have flown too far for it. Pure
// functions.
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace obliq {

/// Where a radar is and how far it looks.
struct RadarPlace {
  LonLat position;
  double r_max_m = 0;
};

/// A scene built for a window depends on it and on the scene file alone, not on the windows before it.
struct SceneWindow {
  LonLat origin;
  std::vector<Reach> reaches;
};

/// The window that a configuration is aimed at.
SceneWindow window_of(const SceneConfig& config);

bool is_same(const SceneWindow& a, const SceneWindow& b);

/// The configuration aimed at a window: its terrain, buildings and prisms stay where they are on the earth.
/// Synthetic shapes stay at the place that they had in `config`.
SceneConfig aimed_at(const SceneConfig& config, const SceneWindow& window);

/// The next window for radars in these places. The origin stays, and with it every post of the grid, until
/// the first radar is three quarters of reorigin_km away from it; then it is that radar's place. Ranges count
/// up to flight.max_reach_km, or up to the longest r_max of the configuration. `ahead`: where the radars will
/// be when the window has served for a while; the discs lie that way, as far as the margin allows.
SceneWindow next_window(const SceneConfig& config, const SceneWindow& current,
                        std::span<const RadarPlace> radars, std::span<const RadarPlace> ahead);

/// Whether it is time to build the next window: a radar's reach has left the current one, or will have used
/// up half of the margin when the radar is where `ahead` says; or the first radar is reorigin_km away from
/// the origin. `ahead` counts as far as next_window can reach, and what next_window gives is not due again
/// while the radars stay or stop: else windows would be built without end. With a [terrain] area the area
/// stays, and only the origin moves.
bool needs_next_window(const SceneConfig& config, const SceneWindow& current,
                       std::span<const RadarPlace> radars, std::span<const RadarPlace> ahead);

/// Posts of the grid over all reaches (an upper bound: elevation models may end before).
double window_posts(const SceneWindow& window, double cell_m);

/// The place a share of the way from one to the other, in longitude and latitude: for neighbours.
LonLat towards(const LonLat& from, const LonLat& to, double share);

/// Great-circle distance on a sphere, within 0.6 % of the ellipsoid's.
double distance_m(const LonLat& a, const LonLat& b);

/// How fast radars move over the ground, from where they are told to be, measured over at least half a
/// second. Radars without poses for kStandsAfter stand still: the last pose may have been a jump,
/// or the last of a flight. For one thread.
class Speedometer {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kStandsAfter{2};

  void note(std::span<const RadarPlace> radars, Time now);
  /// Where these radars will be `later_s` from now if they keep their speeds.
  std::vector<RadarPlace> ahead(std::span<const RadarPlace> radars, double later_s, Time now) const;

 private:
  std::vector<RadarPlace> from_;
  std::vector<RadarPlace> to_;
  Time since_;
  Time heard_;
  double elapsed_s_ = 0;  ///< between the two
};

/// What the files of a scene have for an antenna.
struct GroundThere {
  double coverage = 1;  ///< part of the disc within r_max for which there are files; voids are not looked for
  std::string warning;  ///< empty: the place itself is covered
};

/// What a SceneKeeper does and has done.
struct KeeperState {
  bool building = false;
  std::uint64_t swaps = 0;     ///< windows and reloads that serve or served
  std::uint64_t failures = 0;  ///< windows and reloads that could not be loaded
  std::string last_error;  ///< why ground is missing, or a reload was refused, at present; empty: all is well
  std::string last_failure;  ///< the newest, however long ago
  double well_s = 0;         ///< since it was over; 0: it is not, or there was none
  double last_build_s = 0;
  SceneWindow window;  ///< of the scene that serves
};

}  // namespace obliq
