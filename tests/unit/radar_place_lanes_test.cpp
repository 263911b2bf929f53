// Where samples fall and what they scatter, eight at a time.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/frame_plan.h"
#include "server/radar/samples.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/hash.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

TEST(PlaceLanes, AreTheBitsOfOneSampleAtATimeInEveryInstructionSet) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  const SpeckleField field(world, {10, 1500, -20}, 0.03, 32, 2e-3, 1);
  std::vector<Material> materials(3);
  materials[0].gamma = 0.03;
  materials[1].model = ScatteringModel::geometric_optics;
  materials[2].gamma = 7.5;
  const ScatteringTable scattering(materials, 0.03);
  BinGrid bins;
  bins.n_range = 100;
  bins.r_min_m = 1200;
  bins.r_max_m = 5200;
  bins.range_spacing_m = 40;
  SwathCells cells{};
  cells.axis = bins;
  field.describe_cells(cells);
  constexpr int kSamples = 1021;
  auto samples = std::make_unique<SampleBatch>();
  samples->n = kSamples;
  for (int s = 0; s < kSamples; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const auto random = [&](std::uint64_t salt) { return unit_from_hash(hash_cell(salt, s, 0)); };
    samples->slant_range_m[k] = s == 0 ? bins.r_min_m : s == 1 ? bins.r_max_m : 1000 + 4500 * random(1);
    samples->x_m[k] = 9000 * random(2) - 4500;
    samples->z_m[k] = 9000 * random(3) - 4500;
    samples->solid_angle_sr[k] = 1e-6 * random(4);
    samples->material[k] = static_cast<std::uint8_t>(s % 3);
  }
  for (const bool normalised : {false, true}) {
    EchoFactors factors{};
    factors.range_normalisation = normalised;
    for (std::size_t m = 0; m < materials.size(); ++m) factors.gamma[m] = scattering.constant_gamma(m);
    for (const Kernels& kernels : all_kernels()) {
      auto placed = std::make_unique<BinnedSamples>();
      kernels.bin_samples(cells, factors,
                          {kSamples, samples->slant_range_m.data(), samples->x_m.data(), samples->z_m.data(),
                           samples->solid_angle_sr.data(), samples->material.data()},
                          *placed);
      for (std::size_t k = 0; k < kSamples; ++k) {
        const double r = samples->slant_range_m[k];
        ASSERT_EQ(placed->range_bin[k], bins.range_bin(r)) << kernels.name << ' ' << k;
        ASSERT_EQ(placed->spreading[k], normalised ? 1.0 : (r * r) * (r * r)) << kernels.name << ' ' << k;
        const ScattererKey key(
            field.scatterer(r, {samples->x_m[k], 0, samples->z_m[k]}, kNoFace, samples->material[k]));
        ASSERT_EQ(placed->cell[k], key.place) << kernels.name << ' ' << k;
        if (samples->material[k] == 1) {
          ASSERT_TRUE(std::isnan(placed->sigma_m2[k])) << kernels.name << ' ' << k;
        } else {
          ASSERT_EQ(placed->sigma_m2[k], scattering.cross_section_m2(
                                             samples->material[k], samples->solid_angle_sr[k] * (r * r), 0.5))
              << kernels.name << ' ' << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace obliq
