// Labels: material, building and height of a bin, against closed forms, against frames whose buildings are
// dark, and against the reference renderer; and that they change nothing else. Returns:
// labels_returns_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "server/radar/beam/echo_rows.h"
#include "server/radar/echo/datum_surface.h"
#include "server/truth/reference.h"
#include "tests/accuracy/radar/echo/labels_support.h"
#include "tests/support/made_worlds.h"

namespace obliq::test::labels_test {
namespace {

class LabelsOf : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(EveryWay, LabelsOf, testing::ValuesIn(kWays),
                         [](const auto& way) { return std::string(way.param.name); });

double median_of(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !(x > 0); });
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

TEST_P(LabelsOf, BuildingIsWhatDarkBuildingsLeave) {
  RadarSettings s = GetParam().settings();
  // A beam's weights follow from the mean elevation of what is seen, and so from whether houses are dark: not
  // where all of it is less than 7 degrees down.
  if (GetParam().beam) s.r_min_m = 4200;
  const Frame frame = labelled(striped_town(), s);
  const Frame dark = labelled(striped_town({1, 1, 1, 0}), s);
  const double floor_w = 1e-6 * median_of(frame.bins.power_w);
  int looked_at = 0, with_buildings = 0;
  for (std::size_t bin = 0; bin < frame.bins.power_w.size(); ++bin) {
    if (!(frame.bins.power_w[bin] > floor_w)) continue;
    const double expected = 1 - dark.bins.power_w[bin] / frame.bins.power_w[bin];
    ++looked_at;
    with_buildings += expected > 0.01 ? 1 : 0;
    ASSERT_NEAR(frame.bins.labels.building[bin], expected, 1e-4) << "bin " << bin;
  }
  EXPECT_GT(looked_at, 3000);
  EXPECT_GT(with_buildings, 200);
}

TEST_P(LabelsOf, MaterialHasTheGreatestSumOfPower) {
  const RadarSettings s = GetParam().settings();
  const Frame frame = labelled(striped_town(), s);
  std::vector<std::vector<double>> alone;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<double> lit(4, 0);
    lit[k] = 1;
    alone.push_back(labelled(striped_town(lit), s).bins.power_w);
  }
  std::vector<int> seen(4);
  int mixed = 0, of_one = 0;
  for (std::size_t bin = 0; bin < frame.bins.power_w.size(); ++bin) {
    const std::uint8_t label = frame.bins.labels.material[bin];
    if (!(frame.bins.power_w[bin] > 0)) {
      ASSERT_EQ(label, Labels::kNoMaterial);
      continue;
    }
    double most = 0, second = 0;
    std::size_t winner = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (alone[k][bin] > most) {
        second = most;
        most = alone[k][bin];
        winner = k;
      } else {
        second = std::max(second, alone[k][bin]);
      }
    }
    if (second > 0.9999 * most) continue;  // floats may say either
    ++seen[winner];
    (second > 0 ? mixed : of_one) += 1;
    ASSERT_EQ(label, winner) << "bin " << bin << ": " << most << " and " << second << " W";
  }
  for (const int bins : seen) EXPECT_GT(bins, 50);
  EXPECT_GT(mixed, 500);
  if (!GetParam().beam) {
    EXPECT_GT(of_one, 500);
  }
}

TEST_P(LabelsOf, LevelGroundHasItsHeightAndOneReturn) {
  WorldSpec spec = synthetic_spec(SyntheticKind::flat, 9000, 100);
  spec.radius_factor = 4.0 / 3;
  spec.terrain.shape.base_m = 120;
  const auto scene = make_scene(load_world(spec));
  const Frame frame = labelled(scene, GetParam().settings());
  for (std::size_t bin = 0; bin < frame.bins.power_w.size(); ++bin) {
    if (!(frame.bins.power_w[bin] > 0)) {
      ASSERT_TRUE(std::isnan(frame.bins.labels.height_m[bin]));
      continue;
    }
    // Cells of 100 m are chords of the earth: 0.2 mm below it. Floats keep 450 m below the antenna to 0.03
    // mm.
    ASSERT_NEAR(frame.bins.labels.height_m[bin], 120, 0.002) << "bin " << bin;
    ASSERT_EQ(frame.bins.labels.building[bin], 0.0F);
    ASSERT_EQ(frame.bins.labels.material[bin], 0);
  }
  std::uint8_t most = 0;
  int ones = 0;
  for (const std::uint8_t returns : frame.bins.labels.returns) {
    most = std::max(most, returns);
    ones += returns;
  }
  EXPECT_EQ(most, 1);
  EXPECT_EQ(ones, 48 * 160);
}

TEST_P(LabelsOf, NothingElseDependsOnThem) {
  const RadarSettings s = GetParam().settings();
  const auto scene = striped_town();
  const Frame with = labelled(scene, s);
  const Frame without = render(scene, snapshot(s), pose_over_origin(scene->world(), kLabelHeight_m, 20),
                               {0, s.azimuth_bins}, {});
  expect_same_bits(with.bins, without.bins);
  EXPECT_EQ(with.stats.samples, without.stats.samples);
  EXPECT_TRUE(without.bins.labels.material.empty() && without.bins.labels.returns.empty());
  // Nor do they depend on threads, or on I&Q and states.
  RenderOptions alone;
  alone.threads = 1;
  expect_same_labels(with.bins.labels, labelled(scene, s, alone).bins.labels);
  alone.iq = alone.states = false;
  expect_same_labels(with.bins.labels, labelled(scene, s, alone).bins.labels);
}

TEST_P(LabelsOf, PartsOfASectorHaveThoseOfTheWhole) {
  const RadarSettings s = GetParam().settings();
  const auto scene = striped_town();
  const Frame whole = labelled(scene, s);
  const Pose pose = pose_over_origin(scene->world(), kLabelHeight_m, 20);
  SharpStore store;
  Frame dwells;
  dwells.bins = BinBlock(0, s.azimuth_bins, s.range_bins);
  for (const int first : {0, 16, 32}) {
    RenderOptions options;
    options.labels = true;
    options.sharp = GetParam().beam ? &store : nullptr;
    const Frame part = render(scene, snapshot(s), pose, {first, 16}, options);
    copy_azimuths(part.bins, dwells.bins);
  }
  expect_same_labels(whole.bins.labels, dwells.bins.labels);
}

// A canceller over what moves keeps wedges with the powers of materials: too little for labels.
TEST(Labels, AreWholeWhereWedgesWereKeptWithoutThem) {
  const auto scene = striped_town({1, 1, 1, 1}, true);
  for (const Way& way : kWays) {
    if (!way.beam) continue;
    RadarSettings s = way.settings();
    s.mode = RadarMode::mti;
    s.atmosphere.wind_m_s = 5;
    SharpStore store;
    RenderOptions options;
    options.sharp = &store;
    render(scene, snapshot(s), pose_over_origin(scene->world(), kLabelHeight_m, 20), {0, s.azimuth_bins},
           options);
    EXPECT_GT(store.bytes(), 0u);
    expect_same_labels(labelled(scene, s).bins.labels, labelled(scene, s, options).bins.labels);
  }
}

TEST_P(LabelsOf, NoiseAndRainLeaveThemAlone) {
  RadarSettings s = GetParam().settings();
  const auto scene = striped_town();
  const Frame quiet = labelled(scene, s);
  s.receiver.noise = true;
  s.atmosphere.rain_mm_h = 20;
  const Frame loud = labelled(scene, s);
  EXPECT_TRUE(same_bits(quiet.bins.labels.returns, loud.bins.labels.returns));
  for (std::size_t bin = 0; bin < quiet.bins.power_w.size(); ++bin) {
    if (!(quiet.bins.power_w[bin] > 0)) {
      ASSERT_TRUE(std::isnan(loud.bins.labels.height_m[bin]));
      continue;
    }
    // Behind a pulse rain weighs a bin's ranges, 0.2 % of a bin's length apart in loss.
    ASSERT_NEAR(quiet.bins.labels.building[bin], loud.bins.labels.building[bin], 0.02);
  }
}

/// The most that a bin's mean height may be off, over all bins that the truth says something of.
TEST(Labels, HeightsOfPointsAreThoseOfGeodesy) {
  for (const double factor : {1.0, 4.0 / 3, std::numeric_limits<double>::infinity()}) {
    const WorldFrame frame(40 * kDegree_rad, 10 * kDegree_rad, factor);
    const WorldPoint antenna{{30e3, 0, -20e3}};
    const DatumSurface datum(frame, antenna, 40e3);
    for (double along = 0; along < 6.2; along += 0.3)
      for (double d = 0; d <= 40e3; d += 4e3) {
        const double x = d * std::sin(along), z = d * std::cos(along), y = 2000 - d / 40;
        const double expected_m = frame.geodetic_from_world({{antenna.m.x + x, y, antenna.m.z + z}}).height_m;
        EXPECT_NEAR(datum.height_w(x, z, 3 * y, 3) / 3, expected_m, 0.01 + 1e-6 * std::abs(expected_m))
            << factor << " at " << d;
      }
  }
}

TEST(Labels, HeightIsThatOfTheReferenceRenderer) {
  const World world = [] {
    World made = made_world(4000, 20, [](double x, double z) {
      return 100 + 60 * std::sin(x / 400 + 1) * std::cos(z / 500) + 0.01 * z;
    });
    for (int k = 0; k < 12; ++k)
      add_prism(made, rectangle(-300.0 + 50 * k, 1500.0 + 130 * k, 30, 40), 12.0 + 4 * k);
    return made;
  }();
  std::vector<Material> materials = two_materials();
  materials[1].model = ScatteringModel::constant_gamma;
  const auto scene = make_scene(world, materials);
  const Pose pose = pose_at(world, {0, 500, 0}, 0);
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 20;
  s.azimuth_bins = 40;
  s.r_min_m = 1000;
  s.r_max_m = 3500;
  s.range_bins = 250;
  ReferenceView view;
  view.antenna_m = pose.antenna.m;
  view.bearing_rad = pose.bearing_world_rad;
  view.sector_rad = s.sector_deg * kDegree_rad;
  view.azimuth_bins = s.azimuth_bins;
  view.r_min_m = s.r_min_m;
  view.r_max_m = s.r_max_m;
  view.range_bins = s.range_bins;
  view.wavelength_m = 0.03;
  view.keeps_facets = true;
  const ReferenceBins truth = integrate_reference(world, materials, view, {32, 0.5, 0}, 0, s.azimuth_bins);
  for (const auto& [planes, sub_columns, most_m] : {std::tuple{2, 64, 0.2}, {16, 64, 0.1}, {16, 0, 0.03}}) {
    s.pixel_columns = planes * s.azimuth_bins;
    s.sub_columns = sub_columns;
    RenderOptions options;
    options.labels = true;
    const Frame frame = render(scene, snapshot(s), pose, {0, s.azimuth_bins}, options);
    std::vector<double> off_m, share_off;
    for (int a = 0; a < s.azimuth_bins; ++a) {
      std::vector<double> power_w(static_cast<std::size_t>(s.range_bins)), height_w = power_w,
                                                                           built_w = power_w;
      for (const FacetEcho& facet : truth.facets[static_cast<std::size_t>(a)]) {
        const auto r = static_cast<std::size_t>(facet.range_bin);
        power_w[r] += facet.power_w;
        height_w[r] += facet.power_w * (pose.antenna.m.y + facet.height_m);
        built_w[r] += facet.of_building ? facet.power_w : 0;
      }
      for (std::size_t r = 0; r < power_w.size(); ++r) {
        const std::size_t bin = static_cast<std::size_t>(a * s.range_bins) + r;
        if (!(power_w[r] > 0) || !(frame.bins.power_w[bin] > 0)) continue;
        off_m.push_back(
            std::abs(static_cast<double>(frame.bins.labels.height_m[bin]) - height_w[r] / power_w[r]));
        share_off.push_back(
            std::abs(static_cast<double>(frame.bins.labels.building[bin]) - built_w[r] / power_w[r]));
      }
    }
    std::ranges::sort(off_m);
    std::ranges::sort(share_off);
    const auto at = [](const std::vector<double>& sorted, double part) {
      return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
    };
    std::printf(
        "    %d planes, %d sub-columns: height off by %.3f m in half of %zu bins, %.2f m in 99 %%; building "
        "by "
        "%.4f in 99 %%\n",
        planes, sub_columns, at(off_m, 0.5), off_m.size(), at(off_m, 0.99), at(share_off, 0.99));
    EXPECT_GT(off_m.size(), 5000U);
    EXPECT_LT(at(off_m, 0.5), most_m / 10);
    EXPECT_LT(at(off_m, 0.99), most_m);
  }
}

}  // namespace
}  // namespace obliq::test::labels_test
