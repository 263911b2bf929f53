// ground_map.png and ground_map.tif, read by programs that nobody here wrote.
#include <cairo.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "proto/obliq.pb.h"
#include "server/output/ground_map_png.h"
#include "tests/unit/frame_files_fixture.h"

namespace obliq {
namespace {

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
}  // namespace obliq
