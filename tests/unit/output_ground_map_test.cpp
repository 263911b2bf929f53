// The re-mapping of bins to the ground, and descriptors that no honest server sends.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "proto/obliq.pb.h"
#include "server/output/ground_map.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

wire::FrameDescriptor flat_descriptor() {
  wire::FrameDescriptor d;
  d.set_origin_latitude_deg(33);
  d.set_origin_longitude_deg(-99.5);
  d.set_radius_factor(std::numeric_limits<double>::infinity());
  d.set_antenna_y_m(1000);
  d.mutable_pose()->set_latitude_deg(33);
  d.mutable_pose()->set_longitude_deg(-99.5);
  d.mutable_pose()->set_bearing_deg(90);
  d.mutable_settings()->set_azimuth_bins(60);
  d.mutable_settings()->set_range_bins(90);
  d.set_azimuth_start_deg(60);
  d.set_azimuth_width_deg(1);
  d.set_range_start_m(1000);
  d.set_range_spacing_m(100);
  return d;
}

TEST(GroundMap, ABinAppearsAtItsBearingAndGroundRange) {
  const wire::FrameDescriptor d = flat_descriptor();
  BinBlock bins(0, 60, 90);
  // Azimuth bin 30 is centred on 90.5 degrees, range bin 49 on 5950 m.
  bins.iq[30 * 90 + 49] = {3, 4};
  bins.count[30 * 90 + 49] = 1;
  bins.state[30 * 90 + 49] = static_cast<std::uint8_t>(BinState::sampled);
  for (const double up : {0.0, std::acos(0.0)}) {
    const GroundMap map = map_to_ground(d, bins, up);
    double x = 0, y = 0;
    int n = 0;
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column) {
        const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                           static_cast<std::size_t>(column);
        if (map.magnitude_db[pixel] == GroundMap::kNoValue) continue;
        EXPECT_NEAR(map.magnitude_db[pixel], 20 * std::log10(5.0), 1e-5);
        x += map.left_m + (column + 0.5) * map.pixel_m;
        y += map.top_m - (row + 0.5) * map.pixel_m;
        ++n;
      }
    }
    ASSERT_GT(n, 0);
    // A bin is 100 m by 104 m, a pixel 100 m: its pixels' mean is within one pixel of its centre.
    const double ground = std::sqrt(5950.0 * 5950 - 1000 * 1000);
    const double bearing = 90.5 * std::acos(-1.0) / 180 - up;
    EXPECT_NEAR(x / n, ground * std::sin(bearing), 100);
    EXPECT_NEAR(y / n, ground * std::cos(bearing), 100);
  }
}

TEST(GroundMap, DescriptorsThatNoMapCanBeMadeOfAreRefused) {
  const BinBlock bins(0, 60, 90);
  const auto refuses = [&](auto spoil) {
    wire::FrameDescriptor d = flat_descriptor();
    spoil(d);
    EXPECT_THROW(map_to_ground(d, bins, 0), InputError);
  };
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    refuses([&](wire::FrameDescriptor& d) { d.set_azimuth_width_deg(bad); });
    refuses([&](wire::FrameDescriptor& d) { d.set_range_spacing_m(bad); });
    if (bad == 0) continue;  // a swath may begin at the antenna
    refuses([&](wire::FrameDescriptor& d) { d.set_range_start_m(bad); });
  }
  refuses([](wire::FrameDescriptor& d) { d.set_azimuth_width_deg(6.1); });
  refuses([](wire::FrameDescriptor& d) { d.set_azimuth_start_deg(1e300); });
  refuses([](wire::FrameDescriptor& d) { d.set_antenna_x_m(std::nan("")); });
  refuses([](wire::FrameDescriptor& d) { d.mutable_pose()->set_bearing_deg(HUGE_VAL); });
}

TEST(GroundMap, ASwathThatBeginsAtTheAntennaMakesAMap) {
  wire::FrameDescriptor d = flat_descriptor();
  d.set_range_start_m(0);
  const GroundMap map = map_to_ground(d, BinBlock(0, 60, 90), 0);
  // 60 to 120 degrees, 90 bins of 100 m from 0, in pixels of 100 m: from the antenna to 9 km east.
  EXPECT_NEAR(map.left_m, 0, 100);
  EXPECT_NEAR(map.left_m + map.width * map.pixel_m, 9000, 100);
  EXPECT_NEAR(map.top_m, 4500, 100);
}

TEST(GroundMap, ASectorOfAMillionthOfADegreeMakesAMap) {
  wire::FrameDescriptor d = flat_descriptor();
  d.set_azimuth_width_deg(1e-9);
  const GroundMap map = map_to_ground(d, BinBlock(0, 60, 90), 0);
  EXPECT_GT(map.height, 0);
}

}  // namespace
}  // namespace obliq
