// The inner loops that are compiled for several instruction sets give the bits of the plain code, each of
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "server/radar/echo/scatterer_sums.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/profile/horizon.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/sweep/sweep_ground.h"
#include "terrain/base/hash.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::lanes_test {
namespace {

/// Hills with a void in them, and cells on, beside and over their edges.
class SpeckleLanes : public testing::Test {
 protected:
  static constexpr int kCells = 253;

  SpeckleLanes() {
    HeightGrid& grid = world_.grid;
    for (int j = 40; j < 60; ++j)
      for (int i = 30; i < 90; ++i) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t k = 0; k < kCells; ++k) {
      const auto along = [&](std::uint64_t axis, double first, double last) {
        return first +
               (last - first) * (1.1 * unit_from_hash(hash_cell(axis, static_cast<int>(k), 0)) - 0.05);
      };
      cells_.push_back(
          field_.scatterer(1000 + 50.0 * static_cast<double>(k),
                           {along(1, grid.x0_m, grid.x1_m()), 0, along(2, grid.z0_m, grid.z1_m())}, kNoFace,
                           static_cast<std::uint8_t>(k % 3)));
      place_.push_back(ScattererKey(cells_.back()).place);
      kind_.push_back(ScattererKey(cells_.back()).kind);
      power_w_.push_back(along(3, 1e-12, 1e-9) + 1e-9);
    }
    place_.resize(kCells + 8);
    kind_.resize(kCells + 8);
    power_w_.resize(kCells + 8);
  }

  struct Answer {
    std::vector<double> re = std::vector<double>(kCells + 8);
    std::vector<double> im = std::vector<double>(kCells + 8);
  };
  SpeckleBlock block(Answer& answer) const {
    return {kCells, place_.data(), kind_.data(), power_w_.data(), answer.re.data(), answer.im.data()};
  }

  World world_ = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  SpeckleField field_{world_, {10, 1500, -20}, 0.03, 32, 2e-3, 1};
  std::vector<Scatterer> cells_;
  std::vector<std::uint64_t> place_;
  std::vector<std::uint64_t> kind_;
  std::vector<double> power_w_;
};

/// Greatest distance of a float phasor from its double, by sqrt(power).
double float_error(double modulus) { return 1e-6 * (modulus + 1 / std::max(modulus, 1e-4)); }

TEST_F(SpeckleLanes, GiveTheSameBitsInEveryInstructionSetAndSixDigitsOfOneCellAtATime) {
  const SpeckleGround ground{ground_view(world_.grid, {10, 1500, -20}), 0.03, mix64(1)};
  Answer answered;
  field_.respond(block(answered));
  std::size_t unknown = 0;
  for (const Kernels& kernels : all_kernels()) {
    Answer found;
    kernels.ground_speckle(ground, block(found));
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const std::complex<double> one = std::sqrt(power_w_[k]) * field_.response(cells_[k]);
      const std::complex answer(answered.re[k], answered.im[k]);
      if (std::isnan(found.re[k])) {
        ++unknown;
        EXPECT_EQ(answer, one) << k;
        continue;
      }
      EXPECT_EQ(std::complex(found.re[k], found.im[k]), answer) << kernels.name << ' ' << k;
      const double amplitude = std::sqrt(power_w_[k]);
      EXPECT_LE(std::abs(answer - one) / amplitude, float_error(std::abs(one) / amplitude)) << k;
    }
  }
  EXPECT_GT(unknown, 0u);
  EXPECT_LT(unknown, all_kernels().size() * cells_.size() / 2);
}

/// A scatterer of a bin, in order of its first sample, and its power.
using Sum = std::tuple<std::uint32_t, std::uint64_t, std::uint64_t, double>;

std::vector<Sum> plain_sums(const std::vector<Sum>& samples, std::uint32_t n_range) {
  std::vector<Sum> sums;
  for (std::uint32_t bin = 0; bin < n_range; ++bin) {
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> at;
    for (const auto& [in, place, kind, power] : samples) {
      if (in != bin) continue;
      const auto [found, fresh] = at.try_emplace({place, kind}, sums.size());
      if (fresh) sums.emplace_back(bin, place, kind, 0.0);
      std::get<3>(sums[found->second]) += power;
    }
  }
  return sums;
}

TEST(ScattererSums, AddUpEachScattererOfABinInTheOrderOfItsSamples) {
  // A handful, bins of more than eight scatterers, bins that are sorted, and more than there is room for.
  for (const auto& [n, n_range, n_places] :
       {std::tuple{0, 4u, 1u}, {5, 3u, 2u}, {400, 8u, 40u}, {2000, 2u, 3u}, {60000, 3u, 9000u}}) {
    ScattererSums::Scratch scratch;
    ScattererSums sums(scratch);
    for (int round = 0; round < 2; ++round) {  // the second one in the memory of the first
      sums.restart(static_cast<int>(n_range));
      std::vector<Sum> samples;
      for (int k = 0; k < n; ++k) {
        const std::uint64_t hash = hash_cell(5, k, round);
        samples.emplace_back(hash % n_range, hash / 8 % n_places, hash >> 62, unit_from_hash(hash));
        const auto& [bin, place, kind, power] = samples.back();
        sums.add(bin, ScattererKey(place, kind), power);
      }
      sums.merge();
      std::vector<Sum> found;
      for (std::size_t k = 0; k < sums.size(); ++k)
        found.emplace_back(sums.range_bin(k), sums.places()[k], sums.kinds()[k], sums.powers_w()[k]);
      EXPECT_EQ(found, plain_sums(samples, n_range)) << n;
    }
  }
}

TEST(ScattererSums, AreTheSameInEveryInstructionSet) {
  constexpr std::uint32_t kSamples = 200;
  std::vector<std::uint32_t> end{60, 60, 61, 200};
  std::vector<std::uint64_t> place(kSamples + ScattererLists::kSpare), kind(place);
  std::vector<double> power(place.size());
  for (std::uint32_t k = 0; k < kSamples; ++k) {
    const std::uint64_t hash = hash_cell(6, k, 0);
    place[k] = hash % 23;
    kind[k] = hash >> 63;
    power[k] = unit_from_hash(hash);
  }
  std::vector<std::vector<Sum>> found;
  for (const Kernels& kernels : all_kernels()) {
    std::vector<std::uint32_t> bin(place.size());
    std::vector<std::uint64_t> sum_place(place.size()), sum_kind(place.size());
    std::vector<double> sum_power(place.size());
    ScattererLists lists{end.data(),      place.data(),     kind.data(),
                         power.data(),    bin.data(),       sum_place.data(),
                         sum_kind.data(), sum_power.data(), 0};
    EXPECT_EQ(kernels.sum_scatterers(lists, 0, 4), 4u);
    std::vector<Sum>& sums = found.emplace_back();
    for (std::uint32_t k = 0; k < lists.n; ++k)
      sums.emplace_back(bin[k], sum_place[k], sum_kind[k], sum_power[k]);
    EXPECT_EQ(sums, found.front()) << kernels.name;
  }
}

/// One sample as numbers, to compare.
using Sample = std::vector<double>;

/// Samples by plane, in their order. `each(batch)` fills batches until it returns false.
template <class Each>
std::vector<std::vector<Sample>> samples_of(std::size_t planes, const Each& each) {
  std::vector<std::vector<Sample>> found(planes);
  const auto batch = std::make_unique<SampleBatch>();
  for (bool more = true; more;) {
    more = each(*batch);
    for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k)
      found[static_cast<std::size_t>(batch->azimuth_bin[k])].push_back(
          {batch->slant_range_m[k], batch->solid_angle_sr[k], batch->cos_incidence[k],
           batch->azimuth_offset_rad[k], batch->sin_elevation[k], batch->x_m[k], batch->z_m[k],
           static_cast<double>(batch->face[k]), static_cast<double>(batch->material[k])});
  }
  return found;
}

/// A plane marched by itself.
struct OnePlane {
  SegmentSampler& sampler;
  void visible(const VisibleSegment& piece) { sampler.visible(piece); }
  bool full() const { return sampler.full(); }
};

TEST(SightProfiles, SeeWhatOnePlaneAtATimeSeesInEveryInstructionSet) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    random.settings.frustum = FrustumKind::sweep;
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(random.settings), random.pose).plan;
    const Sector& sector = plan->sector();
    // Planes all round, five to eight of them, whose widths change on the way, to none and back.
    std::vector<GroundShare> shares;
    for (std::size_t p = 0; p < 5 + seed % 4; ++p) {
      const double turn = static_cast<double>(p) / 7 + 0.01 * static_cast<double>(seed);
      GroundShare share;
      share.plane = {static_cast<std::int32_t>(p), 0.1 * static_cast<double>(p), 1, sincos_turns(turn)};
      const double step =
          0.3 * sector.r_max_m * unit_from_hash(hash_cell(4, static_cast<int>(seed), static_cast<int>(p)));
      share.to_m = {step, 1.5 * step, 2 * step, HUGE_VAL};
      share.width_rad = {1, 0, 0.5, 0.25};
      shares.push_back(share);
    }
    std::vector<std::vector<Sample>> expected;
    for (const GroundShare& share : shares) {
      LineOfSight plane(scene->world(), sector.antenna_m, share.plane.bearing, 0, sector.r_max_m, {}, {});
      SegmentSampler sampler(plan->looks_at());
      sampler.set(share.plane);
      OnePlane sink{sampler};
      std::size_t part = 0;
      expected.push_back(samples_of(shares.size(), [&](SampleBatch& batch) {
        sampler.begin(batch);
        while (!sampler.full()) {
          while (share.to_m[part] <= plane.at_m()) ++part;
          if (plane.done()) break;
          sampler.set_width(share.width_rad[part]);
          plane.advance(share.to_m[part], sink);
        }
        return batch.n > 0;
      })[static_cast<std::size_t>(share.plane.azimuth_bin)]);
      compared += expected.back().size();
    }
    for (const Kernels& kernels : all_kernels()) {
      use_kernels(kernels);
      SweepGround ground(plan->looks_at());
      ground.start(shares);
      SegmentSampler sampler(plan->looks_at());
      EXPECT_EQ(samples_of(shares.size(),
                           [&](SampleBatch& batch) {
                             sampler.begin(batch);
                             return ground.next(sampler, batch) || sampler.anything_waiting();
                           }),
                expected)
          << kernels.name << ' ' << random.text;
    }
  }
  EXPECT_GT(compared, 100000u);
}

/// The horizon of a walk over every cell.
struct Walked {
  Horizon<double> horizon;
  double antenna_y_m;
  void ground(const GroundSegment& piece) {
    for (const double d : {piece.d0_m, piece.d1_m})
      horizon.raise(d, piece.start_m + piece.rise * d - antenna_y_m, false);
  }
  static void gap(double, double) {}
  static bool enough() { return false; }
};

TEST(GroundHorizons, AreThoseOfAWalkOverEveryCell) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    const auto scene = test::scene_of(random);
    const HeightGrid& grid = scene->world().grid;
    const glm::dvec3 antenna = random.pose.antenna.m;
    const double half_width_rad = 0.01;
    for (int p = 0; p < 8; ++p) {
      const double turn = unit_from_hash(hash_cell(7, static_cast<int>(seed), p));
      const HorizonBound ridge(*scene, antenna, sincos_turns(turn), half_width_rad, 5000);
      const SinCos bearing = sincos_turns(turn + (p - 4) * half_width_rad / 4 / 6.3);
      const double to_m = 4000 * unit_from_hash(hash_cell(8, static_cast<int>(seed), p));
      const Horizon<double> horizon = ground_horizon(*scene, ridge, antenna, bearing, to_m);
      Walked walked{{}, antenna.y};
      GroundWalk(grid, antenna, bearing.sin, bearing.cos, 0, to_m).advance(to_m, walked);
      ASSERT_EQ(horizon.d_m > 0, walked.horizon.d_m > 0) << random.text;
      if (!(horizon.d_m > 0)) continue;
      ++found;
      const double slope = walked.horizon.h_m / walked.horizon.d_m;
      EXPECT_NEAR(horizon.h_m / horizon.d_m, slope, 1e-11 * (1 + std::abs(slope))) << random.text;
    }
  }
  EXPECT_GT(found, 1000);
}

TEST(GroundHorizons, AlongALineOfTheMeshAreThoseBesideIt) {
  // From over a node, along grid lines and diagonals, and off them by what a sine or cosine is rounded by.
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 9000, 50)));
  const HeightGrid& grid = scene->world().grid;
  const glm::dvec3 antenna(grid.node_x_m(grid.nx / 2), 1500, grid.node_z_m(grid.nz / 2));
  for (int k = 0; k < 8; ++k) {
    for (const double off : {0.0, 1e-17, -1e-17, 6e-17, 2e-16, -2e-16, 1e-14, -1e-14, 1e-12, 1e-10}) {
      const SinCos exact = sincos_turns(k / 8.0);
      const SinCos bearing{exact.sin + off * exact.cos, exact.cos - off * exact.sin};
      const SinCos apart{exact.sin + 1e-9 * exact.cos, exact.cos - 1e-9 * exact.sin};
      for (const double to_m : {700.0, 2000.0, 5000.0}) {
        const HorizonBound ridge(*scene, antenna, exact, 0, to_m);
        const Horizon<double> horizon = ground_horizon(*scene, ridge, antenna, bearing, to_m);
        Walked beside{{}, antenna.y};
        GroundWalk(grid, antenna, apart.sin, apart.cos, 0, to_m).advance(to_m, beside);
        EXPECT_LE(horizon.d_m, to_m) << k << ' ' << off;
        EXPECT_NEAR(horizon.h_m / horizon.d_m, beside.horizon.h_m / beside.horizon.d_m, 1e-6)
            << k << ' ' << off;
      }
    }
  }
}

TEST(GroundHorizons, AreTheSameInEveryInstructionSet) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  const GroundView ground = ground_view(world.grid, {10, 1500, -20});
  for (int p = 0; p < 1000; ++p) {
    const SinCos bearing = sincos_turns(p / 1000.0);
    const ProfileStretch along{bearing.sin, bearing.cos, 4.0 * p,
                               4.0 * p + 700.0 * unit_from_hash(hash_cell(9, p, 0))};
    const HorizonPoint expected = all_kernels().front().highest_ground(ground, along);
    for (const Kernels& kernels : all_kernels()) {
      const HorizonPoint point = kernels.highest_ground(ground, along);
      EXPECT_EQ(point.d_m, expected.d_m) << kernels.name;
      EXPECT_EQ(point.h_m, expected.h_m) << kernels.name;
    }
  }
}

}  // namespace
}  // namespace obliq::lanes_test
