#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "server/radar/echo/speckle.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

class SpeckleTest : public testing::Test {
 protected:
  World world_ = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  glm::dvec3 antenna_{10, 1500, -20};
  double lambda_ = 0.03;
  SpeckleField field(const glm::dvec3& antenna, std::int64_t seed = 1) const {
    return SpeckleField(world_, antenna, lambda_, 32, 2e-3, seed);
  }
};

TEST_F(SpeckleTest, GroundAmplitudesAreCircularGaussianWithUnitPower) {
  const SpeckleField speckle = field(antenna_);
  std::complex<double> mean = 0;
  double power = 0, power2 = 0;
  constexpr int n = 300;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const std::complex<double> u =
          speckle.response(speckle.scatterer(3000, {i * 9.0, 0, j * 9.0}, kNoFace, 0));
      mean += u;
      power += std::norm(u);
      power2 += std::norm(u) * std::norm(u);
    }
  }
  constexpr double count = n * n;
  // Standard errors: 1/sqrt(n) = 0.0033 for mean and power; |u|^4 of an exponential has variance 20: 0.015.
  EXPECT_LT(std::abs(mean / count), 5 * 0.0033);
  EXPECT_NEAR(power / count, 1, 5 * 0.0033);
  EXPECT_NEAR(power2 / count, 2, 5 * 0.015);
}

TEST_F(SpeckleTest, CellsAreAtMostHalfABinAndPowersOfTwo) {
  const SpeckleField speckle = field(antenna_);
  for (double r = 100; r < 90000; r *= 1.1) {
    const Scatterer s = speckle.scatterer(r, {1, 0, 1}, kNoFace, 0);
    const double side = std::ldexp(1.0, s.level);
    const double octave = std::exp2(std::floor(std::log2(r)));
    EXPECT_LE(side, 0.5 * std::min(32.0, octave * 2e-3));
    EXPECT_GT(2 * side, 0.5 * std::min(32.0, octave * 2e-3));
  }
}

TEST_F(SpeckleTest, PhaseTurnsByAQuarterWhenTheAntennaMovesAnEighthOfAWavelengthTowardsTheCell) {
  const SpeckleField before = field(antenna_);
  const Scatterer s = before.scatterer(2000, {1200, 0, 900}, kNoFace, 0);
  const double side = std::ldexp(1.0, s.level);
  const double x = (s.x_cell + 0.5) * side;
  const double z = (s.z_cell + 0.5) * side;
  const glm::dvec3 cell(x, world_.grid.height_at_m(x, z), z);
  glm::dvec3 line = cell - antenna_;
  line = line / std::sqrt(line.x * line.x + line.y * line.y + line.z * line.z);
  const SpeckleField after = field(antenna_ + line * (lambda_ / 8));
  // phase = -4 pi r / lambda: r shrinks by lambda / 8, the phase grows by pi / 2. The second-order term of
  // the range, (lambda / 8)^2 / 2 r, is below 1e-8 m.
  const double turned = std::arg(after.response(s) / before.response(s));
  EXPECT_NEAR(turned, std::numbers::pi / 2, 1e-5);
}

TEST_F(SpeckleTest, DifferentSeedsPlacesLevelsAndMaterialsGiveDifferentHashes) {
  std::set<std::uint64_t> hashes;
  int n = 0;
  for (std::int64_t seed : {1, 2}) {
    const SpeckleField speckle = field(antenna_, seed);
    for (int i = -20; i < 20; ++i)
      for (int j = -20; j < 20; ++j)
        for (int level : {0, 3})
          for (int material : {0, 5}) {
            hashes.insert(speckle.hash(
                {i, j, kNoFace, static_cast<std::int16_t>(level), static_cast<std::uint8_t>(material)}));
            ++n;
          }
  }
  EXPECT_EQ(static_cast<int>(hashes.size()), n);
}

}  // namespace
}  // namespace obliq
