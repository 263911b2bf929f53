// Clutter of whole frames keeps its speckle when the antenna moves: sideways, along its line of sight and up,
// as far as a resolution cell keeps its ground. Geometry and theory are worked out here from the poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/figures.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::clutter_coherence_test {
namespace {

using Complex = std::complex<double>;

/// A way to move the antenna; along is the sector's middle bearing.
struct Move {
  const char* direction;
  double m;
};
constexpr Move kMoves[] = {{"sideways", 0.01}, {"sideways", 0.1}, {"sideways", 1}, {"sideways", 3},
                           {"along", 0.01},    {"along", 0.1},    {"along", 1},    {"along", 3},
                           {"up", 0.1},        {"up", 1},         {"up", 3}};
constexpr std::size_t kMoveCount = std::size(kMoves);
/// Slant ranges, each between two powers of two: cells have one size.
constexpr struct { double from_m, to_m; } kBands[] = {{3720, 4080}, {11500, 12500}, {29000, 31000}};

/// A way to sample the paper's view, and the coherence recorded with it.
struct MovedCase {
  const char* name;
  FrustumKind kind;
  int columns;
  double recorded[kMoveCount][3];  // by kMoves and kBands

  friend std::ostream& operator<<(std::ostream& out, const MovedCase& c) { return out << c.name; }
};

/// The bins that are compared: 12 degrees around the middle, where sideways and along mean something.
class CoherenceOfClutter : public testing::TestWithParam<MovedCase> {
 protected:
  static constexpr double kBearing_deg = 17;
  static constexpr double kBearing_rad = kBearing_deg * std::numbers::pi / 180;
  static constexpr AzimuthRange kMiddle{461, 102};
  static constexpr int kSeeds = 4;

  static std::shared_ptr<const Scene> hills() {
    static const auto scene = [] {
      WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 38000, 30);
      spec.terrain.shape.height_m = 800;
      return test::make_scene(load_world(spec), test::constant_gamma_materials());
    }();
    return scene;
  }

  static RadarSettings settings() {
    RadarSettings s;  // the paper's sector, swath and bins
    s.frustum = GetParam().kind;
    s.pixel_columns = GetParam().columns;
    if (s.pixel_columns > 4096) s.sub_columns = 0;  // the quality "reference"
    return s;
  }

  static double width_rad(const RadarSettings& s) {
    return s.sector_deg * std::numbers::pi / 180 / s.azimuth_bins;
  }
  static double spacing_m(const RadarSettings& s) { return (s.r_max_m - s.r_min_m) / s.range_bins; }

  static glm::dvec3 step(const Move& move) {
    const glm::dvec3 along(std::sin(kBearing_rad), 0, std::cos(kBearing_rad));
    const std::string direction = move.direction;
    return move.m * (direction == "up"      ? glm::dvec3(0, 1, 0)
                     : direction == "along" ? along
                                            : glm::dvec3(along.z, 0, -along.x));
  }

  /// Ground at a bin's range, on its middle bearing.
  static glm::dvec3 place_of(const glm::dvec3& antenna_m, double bearing_rad, double slant_range_m) {
    const HeightGrid& grid = hills()->world().grid;
    double from_m = 0, to_m = slant_range_m;
    glm::dvec3 place(0.0);
    for (int halving = 0; halving < 40; ++halving) {
      const double d_m = (from_m + to_m) / 2;
      place.x = antenna_m.x + d_m * std::sin(bearing_rad);
      place.z = antenna_m.z + d_m * std::cos(bearing_rad);
      place.y = grid.height_at_m(place.x, place.z);
      (glm::length(place - antenna_m) < slant_range_m ? from_m : to_m) = d_m;
    }
    return place;
  }

  /// A bin of a band: its index in the frame and where its middle meets the ground.
  struct Place {
    std::size_t bin;
    std::size_t band;
    double bearing_rad;
    double range_m;
    glm::dvec3 m;
  };

  static std::vector<Place> places(const RadarSettings& s, const glm::dvec3& at) {
    std::vector<Place> found;
    for (int a = 0; a < kMiddle.count; ++a) {
      const double bearing_rad =
          kBearing_rad + (kMiddle.first + a + 0.5 - s.azimuth_bins / 2.0) * width_rad(s);
      for (int r = 0; r < s.range_bins; ++r) {
        const double range_m = s.r_min_m + (r + 0.5) * spacing_m(s);
        for (std::size_t band = 0; band < std::size(kBands); ++band)
          if (range_m > kBands[band].from_m && range_m < kBands[band].to_m)
            found.push_back({static_cast<std::size_t>(a * s.range_bins + r), band, bearing_rad, range_m,
                             place_of(at, bearing_rad, range_m)});
      }
    }
    return found;
  }
};

/// |sum of v' conj(v) turned back by geometry| over the root of both powers: of all bins, also of those that
/// have other cells than before, or no sample in one of the looks.
struct Coherence {
  Complex together = 0;
  double before_w = 0, after_w = 0;
  int bins = 0;

  void add(Complex before, Complex after, long double geometry_rad) {
    together += after * std::conj(before) * test::turned(-geometry_rad);
    before_w += std::norm(before);
    after_w += std::norm(after);
    bins += before != Complex(0) || after != Complex(0) ? 1 : 0;
  }
  double value() const { return std::abs(together) / std::sqrt(before_w * after_w); }
};

/// What resolution cells keep in theory: of evenly rough ground, the mean of exp(-j 4 pi (r_a - r_b) /
/// lambda) over the part of it that both looks have in the bin (Zebker & Villasenor, IEEE TGRS 30, 1992,
/// spatial decorrelation, here with a response of 1 inside the bin and 0 outside). Ground counts by the angle
/// in which it is seen, as constant gamma has it.
class Theory {
 public:
  Theory(const glm::dvec3& antenna_m, double width_rad, double spacing_m, double frequency_ghz)
      : antenna_m_(antenna_m), width_rad_(width_rad), spacing_m_(spacing_m), frequency_ghz_(frequency_ghz) {}

  /// A bin. place(bearing, slant range) is the ground there.
  template <class PlaceOf>
  void add(double bearing_rad, double range_m, const PlaceOf& place) {
    for (int i = 0; i < kAcross; ++i) {
      const double u = bearing_rad + ((i + 0.5) / kAcross - 0.5) * width_rad_;
      double before = -2;
      for (int k = 0; k <= kAlong; ++k) {
        const double edge_m = range_m + (k / static_cast<double>(kAlong) - 0.5) * spacing_m_;
        const double sine = (place(u, edge_m).y - antenna_m_.y) / edge_m;
        if (k > 0)
          parts_.push_back({place(u, edge_m - spacing_m_ / (2 * kAlong)), place(bearing_rad, range_m),
                            bearing_rad, range_m, std::max(0.0, sine - before)});
        before = sine;
      }
    }
  }

  double kept(const glm::dvec3& moved_m) const {
    Complex sum = 0;
    double all = 0;
    for (const Part& p : parts_) {
      all += p.weight;
      const glm::dvec3 to = p.m - moved_m;
      const double shared = inside((std::atan2(to.x, to.z) - p.bearing_rad) / width_rad_, kAcross) *
                            inside((glm::length(to) - p.range_m) / spacing_m_, kAlong);
      if (shared > 0) sum += p.weight * shared * test::turned(turn(p.m, moved_m) - turn(p.middle_m, moved_m));
    }
    return std::abs(sum) / all;
  }

 private:
  static constexpr int kAcross = 20, kAlong = 60;
  struct Part {
    glm::dvec3 m, middle_m;
    double bearing_rad, range_m;  // of the bin
    double weight;
  };

  /// How much of a part of the bin, of which there are so many, lies within -1/2 to 1/2 of the bin.
  static double inside(double middle, int parts) {
    return std::clamp((0.5 - std::abs(middle)) * parts + 0.5, 0.0, 1.0);
  }
  long double turn(const glm::dvec3& m, const glm::dvec3& moved_m) const {
    return test::round_trip_phase_rad(antenna_m_, m, frequency_ghz_) -
           test::round_trip_phase_rad(moved_m, m, frequency_ghz_);
  }

  glm::dvec3 antenna_m_;
  double width_rad_, spacing_m_, frequency_ghz_;
  std::vector<Part> parts_;
};

TEST_P(CoherenceOfClutter, OfAllBinsIsKeptWhenTheAntennaMoves) {
  const auto scene = hills();
  RadarSettings s = settings();
  const glm::dvec3 at(3.25, 3000.5, -7.75);
  const std::vector<Place> seen = places(s, at);
  Coherence found[kMoveCount][3];
  for (s.speckle_seed = 1; s.speckle_seed <= kSeeds; ++s.speckle_seed) {
    const auto iq_from = [&](const glm::dvec3& antenna_m) {
      RenderOptions options;
      options.states = false;
      const Pose pose = test::pose_at(scene->world(), antenna_m, kBearing_deg);
      return render(scene, test::snapshot(s), pose, kMiddle, options).bins.iq;
    };
    const auto before = iq_from(at);
    for (std::size_t move = 0; move < kMoveCount; ++move) {
      const glm::dvec3 moved = at + step(kMoves[move]);
      const auto after = iq_from(moved);
      for (const Place& p : seen)
        found[move][p.band].add(Complex(before[p.bin]), Complex(after[p.bin]),
                                test::round_trip_phase_rad(at, p.m, s.frequency_ghz) -
                                    test::round_trip_phase_rad(moved, p.m, s.frequency_ghz));
    }
  }
  std::vector<Theory> theory(3, Theory(at, width_rad(s), spacing_m(s), s.frequency_ghz));
  for (const Place& p : seen)
    if (p.bin % 97 == 0)  // one in a hundred
      theory[p.band].add(p.bearing_rad, p.range_m, [&](double bearing_rad, double range_m) {
        return place_of(at, bearing_rad, range_m);
      });
  for (std::size_t move = 0; move < kMoveCount; ++move) {
    std::printf("    %5g m %-8s:", kMoves[move].m, kMoves[move].direction);
    for (std::size_t band = 0; band < 3; ++band) {
      const double kept = theory[band].kept(at + step(kMoves[move])), value = found[move][band].value();
      const double km = std::round((kBands[band].from_m + kBands[band].to_m) / 2000);
      std::printf("  %.4f (%.4f) at %.0f km", value, kept, km);
      char name[64];
      std::snprintf(name, sizeof name, "%s_%g_%g", kMoves[move].direction, kMoves[move].m, km);
      test::record_figure(std::string(GetParam().name) + "_" + name, value);
      test::record_figure(std::string("theory_") + name, kept);
      // The oblique frustum samples one bin in four so near.
      EXPECT_GE(found[move][band].bins, 250 * kSeeds);
      // A tenth more loss than recorded: of N bins the coherence has a standard error of (1 - c^2) /
      // sqrt(2 N), at most a twentieth of the loss 1 - c.
      const double loss = 1 - GetParam().recorded[move][band];
      EXPECT_GE(value, 1 - 1.1 * loss - 5e-5) << name;  // as printed
      // Ground that is seen anew cannot be known: speckle that stays with the bins, the named wrong version,
      // is 1. A cell is coarser than theory's ground and answers as a whole, which keeps up to a tenth too
      // much.
      EXPECT_LE(value, kept + 0.12) << name;
      // The mean phase is geometry's too: a millimetre of unmodelled range would leave 0.4 rad.
      if (kMoves[move].m < 1) {
        EXPECT_LT(std::abs(std::arg(found[move][band].together)), 0.05) << name;
      }
    }
    std::printf("\n");
  }
}

constexpr MovedCase kMovedCases[] = {
    {"draft",
     FrustumKind::sweep,
     1024,
     {{0.9921, 0.9981, 0.9990},
      {0.9335, 0.9845, 0.9921},
      {0.4475, 0.8481, 0.9221},
      {0.0054, 0.5705, 0.7695},
      {0.9938, 0.9972, 0.9993},
      {0.9256, 0.9765, 0.9906},
      {0.4642, 0.8331, 0.9159},
      {0.0040, 0.5545, 0.7778},
      {0.9283, 0.9942, 0.9977},
      {0.5008, 0.9586, 0.9920},
      {0.0042, 0.8719, 0.9767}}},
    {"standard",
     FrustumKind::sweep,
     2048,
     {{0.9961, 0.9983, 0.9995},
      {0.9488, 0.9843, 0.9925},
      {0.4767, 0.8370, 0.8999},
      {0.4359, 0.4636, 0.6067},
      {0.9973, 0.9985, 0.9996},
      {0.9499, 0.9818, 0.9941},
      {0.4709, 0.8403, 0.9250},
      {0.0123, 0.5690, 0.7848},
      {0.9449, 0.9962, 0.9995},
      {0.4772, 0.9648, 0.9937},
      {0.0213, 0.8917, 0.9805}}},
    {"reference",
     FrustumKind::sweep,
     8192,
     {{0.9971, 0.9993, 0.9998},
      {0.9716, 0.9937, 0.9976},
      {0.8475, 0.9207, 0.9474},
      {0.5180, 0.7077, 0.7050},
      {0.9994, 0.9998, 0.9999},
      {0.9924, 0.9983, 0.9993},
      {0.7740, 0.9801, 0.9910},
      {0.1472, 0.9222, 0.9636},
      {0.9931, 0.9996, 0.9999},
      {0.7637, 0.9920, 0.9993},
      {0.0937, 0.9500, 0.9968}}},
    {"oblique",
     FrustumKind::oblique,
     2048,
     {{0.9978, 0.9985, 0.9993},
      {0.9430, 0.9811, 0.9928},
      {0.4453, 0.8105, 0.9031},
      {0.0362, 0.4182, 0.5874},
      {0.9971, 0.9989, 0.9996},
      {0.9231, 0.9878, 0.9948},
      {0.3905, 0.8800, 0.9479},
      {0.0187, 0.6575, 0.8585},
      {0.9548, 0.9899, 0.9945},
      {0.5336, 0.8848, 0.9390},
      {0.0616, 0.6561, 0.8495}}},
};

INSTANTIATE_TEST_SUITE_P(Samplings, CoherenceOfClutter, testing::ValuesIn(kMovedCases),
                         test::source_name<testing::TestParamInfo<MovedCase>>);

}  // namespace
}  // namespace obliq::clutter_coherence_test
