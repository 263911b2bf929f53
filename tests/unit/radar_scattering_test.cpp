#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/echo/scattering.h"

namespace obliq {
namespace {

Material material(ScatteringModel model) {
  Material m;
  m.model = model;
  m.gamma = 0.1;
  m.reflectivity = 0.5;
  m.rms_slope = 0.1;
  m.plate_tau = 2;
  m.plate_exponent = 2;
  return m;
}

TEST(Scattering, ConstantGammaIsGammaTimesProjectedArea) {
  const ScatteringTable table({material(ScatteringModel::constant_gamma)}, 0.03);
  for (double cosine : {1.0, 0.5, 1e-9, 0.0}) EXPECT_DOUBLE_EQ(table.cross_section_m2(0, 30, cosine), 3.0);
}

TEST(Scattering, GeometricOpticsMatchesItsFormulaAndKeepsItsFloor) {
  const ScatteringTable table({material(ScatteringModel::geometric_optics)}, 0.03);
  for (double degrees : {0.0, 3.0, 10.0, 25.0}) {
    const double theta = degrees * std::numbers::pi / 180;
    const double t = std::tan(theta);
    // sigma0 = R2 exp(-t^2/2s^2) sec^4 / (2 s^2), and sigma = sigma0 A with A = projected area / cos.
    const double expected = 0.5 * std::exp(-t * t / 0.02) / std::pow(std::cos(theta), 5) / 0.02 + 0.1;
    EXPECT_NEAR(table.cross_section_m2(0, 1, std::cos(theta)) / expected, 1, 1e-12) << degrees;
  }
  // A roof at 75 degrees: the lobe is exp(-696), the floor is left.
  EXPECT_NEAR(table.cross_section_m2(0, 1, std::cos(75 * std::numbers::pi / 180)), 0.1, 1e-15);
  EXPECT_DOUBLE_EQ(table.cross_section_m2(0, 1, 0), 0.1);
}

TEST(Scattering, FlatPlateIsThePapersEquation12Corrected) {
  const double lambda = 0.03;
  const ScatteringTable table({material(ScatteringModel::flat_plate)}, lambda);
  // 4 pi tau (A cos theta)^2 / lambda^2 with tau = 2 cos^2 theta, projected area 3 m^2, theta 60 degrees.
  const double expected = 4 * std::numbers::pi * 2 * 0.25 * 9 / (lambda * lambda);
  EXPECT_NEAR(table.cross_section_m2(0, 3, 0.5) / expected, 1, 1e-14);
  EXPECT_EQ(table.cross_section_m2(0, 3, 0), 0);
}

TEST(Scattering, ZeroReflectivityAndZeroGammaGiveExactZeros) {
  Material black = material(ScatteringModel::geometric_optics);
  black.gamma = 0;
  black.reflectivity = 0;
  const ScatteringTable table({black}, 0.03);
  for (double cosine : {1.0, 0.3, 0.0}) EXPECT_EQ(table.cross_section_m2(0, 5, cosine), 0);
}

}  // namespace
}  // namespace obliq
