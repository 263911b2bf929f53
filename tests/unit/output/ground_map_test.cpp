// The re-mapping of bins to the ground, and descriptors that no honest server sends.
// ground_map.png and ground_map.tif, read by programs that nobody here wrote.
#include "server/output/ground_map.h"

#include <cairo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "proto/obliq.pb.h"
#include "server/output/ground_map_png.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"
#include "terrain/height_grid.h"
#include "tests/unit/output/frame_files_fixture.h"

namespace obliq::ground_map_test {
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

GroundMap north_or_bearing_up(const wire::FrameDescriptor& d, double up_rad) {
  GroundMapRequest wish;
  wish.up_rad = up_rad;
  wish.least_pixel_m = d.range_spacing_m();
  return map_to_ground(MapProjection(d), d.settings().azimuth_bins(), d.settings().range_bins(), wish);
}

TEST(GroundMap, ABinAppearsAtItsBearingAndGroundRange) {
  const wire::FrameDescriptor d = flat_descriptor();
  BinBlock bins(0, 60, 90);
  // Azimuth bin 30 is centred on 90.5 degrees, range bin 49 on 5950 m.
  bins.iq[30 * 90 + 49] = {3, 4};
  bins.count[30 * 90 + 49] = 1;
  bins.state[30 * 90 + 49] = static_cast<std::uint8_t>(BinState::sampled);
  for (const double up : {0.0, std::acos(0.0)}) {
    const GroundMap map = north_or_bearing_up(d, up);
    const BinLevels levels = bin_levels(d, bins);
    double x = 0, y = 0;
    int n = 0;
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column) {
        const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                           static_cast<std::size_t>(column);
        if (!map.is_bin(pixel) || levels.db[map.bin[pixel]] == BinLevels::kNoValue) continue;
        EXPECT_NEAR(levels.db[map.bin[pixel]], 20 * std::log10(5.0), 1e-5);
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
  const auto refuses = [&](auto spoil) {
    wire::FrameDescriptor d = flat_descriptor();
    spoil(d);
    EXPECT_THROW(north_or_bearing_up(d, 0), InputError);
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
  refuses([](wire::FrameDescriptor& d) { d.mutable_pose()->set_latitude_deg(91); });
  refuses([](wire::FrameDescriptor& d) { d.set_range_spacing_m(1e9); });
  refuses([](wire::FrameDescriptor& d) { d.mutable_pose()->set_bearing_deg(HUGE_VAL); });
}

TEST(GroundMap, ASwathThatBeginsAtTheAntennaMakesAMap) {
  wire::FrameDescriptor d = flat_descriptor();
  d.set_range_start_m(0);
  const GroundMap map = north_or_bearing_up(d, 0);
  // 60 to 120 degrees, 90 bins of 100 m from 0, in pixels of 100 m: from the antenna to 9 km east.
  EXPECT_NEAR(map.left_m, 0, 100);
  EXPECT_NEAR(map.left_m + map.width * map.pixel_m, 9000, 100);
  EXPECT_NEAR(map.top_m, 4500, 100);
}

TEST(GroundMap, RingsAndPixelsAreAtTheSamePlacesHoweverFarTheRadarIsFromTheModel) {
  wire::FrameDescriptor d = flat_descriptor();
  for (const double k : {std::numeric_limits<double>::infinity(), 4.0 / 3}) {
    for (const double latitude_deg : {33.0, 34.0, 46.0}) {
      d.set_radius_factor(k);
      d.mutable_pose()->set_latitude_deg(latitude_deg);
      const WorldFrame frame(33 * kDegree_rad, -99.5 * kDegree_rad, k);
      const Geodetic at{latitude_deg * kDegree_rad, -99.5 * kDegree_rad, 1000};
      const glm::dvec3 antenna = frame.world_from_geodetic(at).m;
      d.set_antenna_x_m(antenna.x);
      d.set_antenna_y_m(antenna.y);
      d.set_antenna_z_m(antenna.z);
      d.set_north_rad(frame.north_rad(at));
      const MapProjection projection(d);
      for (const double bearing : {1.1, 1.6, 2.0}) {
        for (const double slant_m : {4000.0, 9900.0}) {
          // A ring's place, taken the way that a pixel is: the range that was drawn, in its direction.
          const glm::dvec3 p = projection.offset(projection.place(bearing, slant_m));
          EXPECT_NEAR(std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z), slant_m, 1) << latitude_deg << " " << k;
          EXPECT_NEAR(std::remainder(std::atan2(p.x, p.z) - bearing - d.north_rad(), 2 * std::acos(-1.0)), 0,
                      1e-4)
              << latitude_deg << " " << k;
        }
      }
      // No pixel of a bin is outside of the bounds, and the map is filled to its edges.
      const GroundMap map = north_or_bearing_up(d, 0);
      EXPECT_EQ(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), map.bin.size());
      std::size_t seen = 0;
      for (std::size_t pixel = 0; pixel < map.bin.size(); ++pixel) seen += map.is_bin(pixel) ? 1U : 0U;
      // 60 degrees between 1 and 10 km are 0.54 of their bounds, east up to 10 km.
      EXPECT_GT(static_cast<double>(seen), 0.45 * static_cast<double>(map.bin.size())) << latitude_deg;
    }
  }
}

TEST(GroundMap, APeakIsWhereItStandsWhenTheGroundIsGivenAndNearerToTheAntennaWhenNot) {
  wire::FrameDescriptor d = flat_descriptor();
  d.set_antenna_y_m(4000);
  HeightGrid ground;
  ground.cell_m = 50;
  ground.x0_m = -1000;
  ground.z0_m = -10000;
  ground.nx = 260;
  ground.nz = 400;
  ground.y_m.assign(260 * 400, 0.0f);
  // A table of 400 m, 300 m across, around 5 km east of the antenna and 1 km north of it.
  const double east_m = 5000, north_m = 1000, height_m = 400;
  for (int j = 0; j < ground.nz; ++j)
    for (int i = 0; i < ground.nx; ++i)
      if (std::abs(ground.node_x_m(i) - east_m) <= 150 && std::abs(ground.node_z_m(j) - north_m) <= 150)
        ground.y_m[ground.index(i, j)] = static_cast<float>(height_m);
  const double slant_m =
      std::sqrt(east_m * east_m + north_m * north_m + (4000 - height_m) * (4000 - height_m));
  const auto azimuth = static_cast<std::uint32_t>(std::atan2(east_m, north_m) / kDegree_rad - 60);
  const auto range = static_cast<std::uint32_t>((slant_m - 1000) / 100);
  GroundMapRequest wish;
  wish.least_pixel_m = 25;
  const auto distance_m = [&](const HeightGrid* heights) {
    wish.ground = heights;
    const GroundMap map = map_to_ground(MapProjection(d), 60, 90, wish);
    double nearest_m = HUGE_VAL;
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column) {
        if (map.bin[static_cast<std::size_t>(row * map.width + column)] != azimuth * 90 + range) continue;
        const double x = map.left_m + (column + 0.5) * map.pixel_m - east_m;
        const double z = map.top_m - (row + 0.5) * map.pixel_m - north_m;
        nearest_m = std::min(nearest_m, std::hypot(x, z));
      }
    }
    return nearest_m;
  };
  EXPECT_LT(distance_m(&ground), 25) << "a pixel";
  // Its slant range meets level ground sqrt(6242^2 - 4000^2) = 4792 m out instead of 5099 m, give or take a
  // bin.
  EXPECT_NEAR(distance_m(nullptr), 307, 125);
}

TEST(GroundMap, ASectorOfAMillionthOfADegreeMakesAMap) {
  wire::FrameDescriptor d = flat_descriptor();
  d.set_azimuth_width_deg(1e-9);
  const GroundMap map = north_or_bearing_up(d, 0);
  EXPECT_GT(map.height, 0);
}

/// What GDAL's own program says about a file.
std::string gdalinfo(const fs::path& file) {
  const fs::path said = file.string() + ".said";
  const int code = std::system(("gdalinfo '" + file.string() + "' > '" + said.string() + "' 2>&1").c_str());
  return code == 0 ? slurp(said) : "";
}

TEST_F(FrameFilesTest, AmplitudesTimesTheSquareOfTheRangeHaveSquareMetresInTheirUnit) {
  const bool readable = std::system("gdalinfo --version > /dev/null 2>&1") == 0;
  double largest[2] = {0, 0};
  for (const bool normalised : {false, true}) {
    settings_.range_normalisation = normalised;
    render_to(folder_);
    const auto frame = nlohmann::json::parse(slurp(folder_ / "frame.json"))["frame"];
    EXPECT_EQ(frame["unit"], normalised ? "sqrt(W) m^2" : "sqrt(W)");
    EXPECT_EQ(frame["power_unit"], normalised ? "W m^4" : "W");
    if (readable) {
      EXPECT_NE(gdalinfo(folder_ / "ground_map.tif")
                    .find(normalised ? "Description = magnitude, dB re sqrt(W) m^2\n"
                                     : "Description = magnitude, dB re sqrt(W)\n"),
                std::string::npos);
    }
    for (const double power : frame_.bins.power_w) largest[normalised] = std::max(largest[normalised], power);
  }
  // Both are the same echo: the ratio is the fourth power of a range of the swath, 1.5 to 9 km.
  EXPECT_GT(largest[1] / largest[0], std::pow(1500.0, 4));
  EXPECT_LT(largest[1] / largest[0], std::pow(9000.0, 4));
}

/// A PNG as cairo reads it: what nobody here wrote.
struct ReadPicture {
  explicit ReadPicture(const fs::path& file)
      : surface(cairo_image_surface_create_from_png(file.c_str()), cairo_surface_destroy),
        width(cairo_image_surface_get_width(surface.get())),
        height(cairo_image_surface_get_height(surface.get())) {}
  std::uint32_t at(int x, int y) const {
    const unsigned char* row = cairo_image_surface_get_data(surface.get()) +
                               static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface.get());
    return reinterpret_cast<const std::uint32_t*>(row)[x] & 0xffffff;
  }
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface;
  int width, height;
};

TEST_F(FrameFilesTest, WithTheSameDbRangeTwoPicturesCanBeCompared) {
  render_frame();
  FrameFileOptions options;
  options.picture.side = 300;
  const auto scale = write_frame_files(folder_ / "own", descriptor_, summary_, frame_.bins, options).scale;
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->low, std::round(scale->low)) << "whole decibels";
  EXPECT_GT(scale->high, scale->low);
  // Ten times the amplitude, 20 dB: a scale that is 20 dB higher draws the same pixels, its own does so too.
  BinBlock brighter = frame_.bins;
  for (auto& value : brighter.iq) value *= 10;
  options.picture.db_range = DbRange{scale->low + 20, scale->high + 20};
  write_frame_files(folder_ / "higher", descriptor_, summary_, brighter, options);
  options.picture.db_range = scale;
  write_frame_files(folder_ / "same", descriptor_, summary_, brighter, options);
  const ReadPicture own(folder_ / "own" / "ground_map.png");
  const ReadPicture higher(folder_ / "higher" / "ground_map.png");
  const ReadPicture same(folder_ / "same" / "ground_map.png");
  ASSERT_EQ(own.width, higher.width);
  ASSERT_EQ(own.height, higher.height);
  int map_pixels = 0, moved = 0, brighter_pixels = 0;
  for (int y = 40; y < 240; ++y) {
    for (int x = own.width / 2 - 100; x < own.width / 2 + 100; ++x) {
      ++map_pixels;
      const auto green = [&](const ReadPicture& p) { return static_cast<int>(p.at(x, y) >> 8 & 0xff); };
      // Rounding of a float's logarithm may move a pixel by a grey of 255.
      moved += std::abs(green(own) - green(higher)) > 2 ? 1 : 0;
      brighter_pixels += green(same) > green(own) ? 1 : 0;
    }
  }
  EXPECT_EQ(moved, 0);
  EXPECT_GT(brighter_pixels, map_pixels / 2);
}

TEST_F(FrameFilesTest, AStreamKeepsTheScaleOfItsFirstFrameUntilSettingsChange) {
  render_frame();
  BinBlock brighter = frame_.bins;
  for (auto& value : brighter.iq) value *= 10;
  SteadyScale scale(std::nullopt);
  FrameFileOptions options;
  options.picture.side = 200;
  const auto draw = [&](const BinBlock& bins) {
    options.picture.db_range = scale.next(descriptor_);
    const auto used = write_frame_files(folder_, descriptor_, summary_, bins, options).scale;
    scale.drawn(used);
    return used.value_or(DbRange{}).low;
  };
  const double first = draw(frame_.bins);
  descriptor_.mutable_pose()->set_bearing_deg(41);
  EXPECT_EQ(draw(brighter), first) << "a pose is no setting";
  descriptor_.mutable_settings()->set_gain_db(20);
  EXPECT_NEAR(draw(brighter), first + 20, 1);
  SteadyScale given(DbRange{-5, 5});
  EXPECT_EQ(given.next(descriptor_)->low, -5);
}

TEST_F(FrameFilesTest, WordsOverTheBrightestGroundStandOnDarkPlates) {
  settings_.sector_deg = 360;
  render_frame();
  BinBlock bright = frame_.bins;
  for (std::size_t i = 0; i < bright.state.size(); ++i) {
    bright.iq[i] = 1e3f;
    bright.count[i] = 1;
    bright.state[i] = static_cast<std::uint8_t>(BinState::sampled);
  }
  FrameFileOptions options;
  options.picture.side = 800;
  options.picture.up = MapUp::north;
  options.picture.db_range = DbRange{0, 1};
  write_frame_files(folder_, descriptor_, summary_, bright, options);
  const ReadPicture picture(folder_ / "ground_map.png");
  // White ground within the middle half of the map, but for rings, bearings, the antenna and labels. A
  // label's plate is a run of dark pixels, its words are light ones within it.
  int white = 0, dark_runs = 0;
  for (int y = 230; y < 630; ++y) {
    int run = 0, light_inside = 0;
    for (int x = 260; x < 660; ++x) {
      const int green = static_cast<int>(picture.at(x, y) >> 8 & 0xff);
      white += green > 240 ? 1 : 0;
      if (green < 110) ++run;
      if (green >= 110 && run > 0 && run < 40) ++light_inside;
      if (light_inside > 30) run = light_inside = 0;
      if (run > 12) {
        ++dark_runs;
        run = light_inside = 0;
      }
    }
  }
  EXPECT_GT(white, 400 * 400 / 2);
  EXPECT_GT(dark_runs, 15) << "the plates of three rings' labels";
}

}  // namespace
}  // namespace obliq::ground_map_test
