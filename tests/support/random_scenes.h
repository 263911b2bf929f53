#pragma once
// Random small scenes for property tests: any ground, any prisms, any legal pose, all from one seed. Built in
// memory, without a file. A failing test prints scene.text, which holds the seed.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "server/radar/geometry/pose.h"
#include "server/radar/settings.h"
#include "server/scene/scene.h"
#include "terrain/base/hash.h"
#include "terrain/world.h"

namespace obliq::test {

/// Random numbers from a seed, without the standard library's distributions, which differ between libraries.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(mix64(seed)) {}

  std::uint64_t bits() { return state_ = mix64(state_); }
  double unit() { return unit_from_hash(bits()); }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// Evenly spread over factors, for sizes of unknown order.
  double logarithmic(double low, double high);
  /// low to high, both included.
  int integer(int low, int high) {
    return low + static_cast<int>(bits() %
                                  (static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1));
  }
  bool chance(double probability) { return unit() < probability; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[integer(0, static_cast<int>(values.size()) - 1)];
  }

 private:
  std::uint64_t state_;
};

struct RandomSceneOptions {
  int nodes = 33;          ///< along x; along z up to a quarter fewer or more
  bool square = false;     ///< as many nodes along z as along x
  int most_prisms = 6;     ///< fewer stand where one falls on a void
  bool voids = true;       ///< one scene in three has some
  bool outside = true;     ///< one antenna in ten stands just outside the grid
  bool curved = true;      ///< one scene in two has earth curvature
  bool far_origin = true;  ///< one grid in six lies about 100 km from the world's origin
  double most_sector_deg = 360;
};

/// A world, an antenna in it that place_antenna() would accept, and settings with few bins and pixels. The
/// frustum is the sweep, which any pose allows; plan_frame() says whether another kind fits.
///
/// Ground: flat, white noise, terraces, ridges, a cliff, spikes, smooth hills; with voids; with or without
/// curvature. Prisms: rectangles at any angle, needles, courtyards, overlapping, nested, tiny (down to 10 cm)
/// and huge (up to half the grid). Antenna: above everything, below the peaks, near the grid's edge or just
/// outside it. Sector: 1 to 360 degrees, any bearing.
///
/// All world coordinates are multiples of 2^-10 m (heights float32), so that turning a scene by half a turn
/// about a grid centre is exact.
struct RandomScene {
  std::uint64_t seed = 0;
  World world;
  Pose pose;
  RadarSettings settings;
  std::string text;  ///< one line: the seed and what the scene is made of
};

RandomScene random_scene(std::uint64_t seed, const RandomSceneOptions& options = {});

/// Its world, which is moved out of it, of one material whatever the number.
std::shared_ptr<const Scene> scene_of(RandomScene& random);

}  // namespace obliq::test
