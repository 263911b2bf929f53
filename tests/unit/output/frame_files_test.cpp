// The files of a frame, read back with other people's readers where there is one.
// Where a bin lies: the worked bin that PROTOCOL.md prints, against GeographicLib and the pictures'
// projection.
#include "server/output/frame_files.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <GeographicLib/AzimuthalEquidistant.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/output/map_projection.h"
#include "server/output/sample_textures.h"
#include "server/radar/frame_plan.h"
#include "server/scene/exact_hit.h"
#include "terrain/frames.h"
#include "tests/support/scenes.h"
#include "tests/unit/output/frame_files_fixture.h"

namespace obliq::frame_files_test {
namespace {

std::string python_with_numpy() {
  for (const std::string python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import numpy' 2>/dev/null").c_str()) == 0) return python;
  return "";
}

TEST_F(FrameFilesTest, TheSameFrameGivesTheSameBytes) {
  render_to(folder_ / "a");
  render_to(folder_ / "b");
  for (const char* name : {"bins.npy", "power.npy", "count.npy", "state.npy", "frame.json", "ground_map.png",
                           "ground_map.tif"}) {
    ASSERT_GT(fs::file_size(folder_ / "a" / name), 0u) << name;
    EXPECT_EQ(slurp(folder_ / "a" / name), slurp(folder_ / "b" / name)) << name;
  }
}

TEST_F(FrameFilesTest, NumpyReadsTheArraysWithTheirShapesAndTypes) {
  const std::string python = python_with_numpy();
  if (python.empty()) GTEST_SKIP() << "neither /usr/bin/python3 nor python3 has numpy (apt: python3-numpy)";
  render_to(folder_);
  double power = 0;
  for (double p : frame_.bins.power_w) power += p;
  std::ostringstream script;
  script.precision(17);
  script << "import numpy as n; d='" << folder_.string()
         << "/'; b=n.load(d+'bins.npy'); p=n.load(d+'power.npy');"
         << "c=n.load(d+'count.npy'); s=n.load(d+'state.npy');"
         << "assert b.shape==p.shape==c.shape==s.shape==(45,33), b.shape;"
         << "assert (b.dtype,p.dtype,c.dtype,s.dtype)==('<c8','<f8','<u4','|u1'), (b.dtype,p.dtype);"
         << "assert abs(p.sum()/" << power << "-1)<1e-12, p.sum(); assert ((c>0)==(s==1)).all();"
         << "assert c.sum()==" << frame_.stats.samples << "; assert b[7,5]==n.complex64(complex("
         << static_cast<double>(frame_.bins.iq[7 * 33 + 5].real()) << ","
         << static_cast<double>(frame_.bins.iq[7 * 33 + 5].imag()) << "))";
  EXPECT_EQ(std::system((python + " -c \"" + script.str() + "\"").c_str()), 0);
}

TEST_F(FrameFilesTest, FrameJsonNamesEveryParameterAndTheBinEdges) {
  render_to(folder_);
  const auto json = nlohmann::json::parse(slurp(folder_ / "frame.json"));
  EXPECT_EQ(json["frame"]["settings"]["plates"], "spread");  // the scene file's word
  EXPECT_EQ(json["azimuth_edges_deg"].size(), 46u);
  EXPECT_EQ(json["range_edges_m"].size(), 34u);
  EXPECT_DOUBLE_EQ(json["range_edges_m"][33], 9000);
  EXPECT_DOUBLE_EQ(json["azimuth_edges_deg"][0], 40 - 60);
  EXPECT_EQ(json["frame"]["settings"]["frustum"], "symmetric");
  EXPECT_TRUE(json["frame"]["radius_factor"].is_null()) << "JSON has no infinity, and a text is no number";
  EXPECT_EQ(json["planes"], nlohmann::json({"iq", "power", "count", "state"}));
  EXPECT_NE(json["notes"]["range_edges_m"].get<std::string>().find("slant"), std::string::npos);
  // The edges come last, many per line, so that the rest is easy to read.
  const std::string text = slurp(folder_ / "frame.json");
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 235)
      << "one a line they alone were 80 and 2 x 1025 of a large frame";
  EXPECT_GT(text.find("azimuth_edges_deg\": ["), text.find("\"notes\""));
  EXPECT_EQ(json["summary"]["rays"], frame_.stats.rays);
  EXPECT_EQ(json["summary"]["coverage"], 1.0);
  EXPECT_EQ(json["frame"]["phase_sign"], -1);
  const SourceError& error = scene_->world().report.source_error;
  EXPECT_GT(error.posts, 0u);
  EXPECT_EQ(json["frame"]["source_error"]["posts"], error.posts);
  EXPECT_EQ(json["frame"]["source_error"]["p95_m"], error.p95_m);
  EXPECT_NEAR(json["frame"]["wavelength_m"], 299792458.0 / 10e9, 1e-15);
}

TEST_F(FrameFilesTest, OpenExrTexturesHoldDoubleRangesInTwoChannels) {
  class Reference : public SampleTextures {
   public:
    using SampleTextures::SampleTextures;
    void on_hit(std::uint32_t pixel, double azimuth, const ExactHit& hit) override {
      SampleTextures::on_hit(pixel, azimuth, hit);
      const std::scoped_lock lock(mutex);
      ranges[pixel] = hit.slant_range_m;
    }
    std::mutex mutex;
    std::map<std::uint32_t, double> ranges;
  };
  Reference textures(90, 70);
  render_to(folder_, &textures);
  const fs::path path = folder_ / "samples.exr";
  textures.write(path);
  Imf::InputFile file(path.c_str());
  const auto window = file.header().dataWindow();
  ASSERT_EQ(window.max.x - window.min.x + 1, 90);
  ASSERT_EQ(window.max.y - window.min.y + 1, 70);
  for (const char* name : {"azimuth_rad", "incidence_rad", "normal.x", "normal.y", "normal.z", "position.x",
                           "position.y", "position.z"})
    EXPECT_TRUE(file.header().channels().findChannel(name)) << name;
  std::vector<float> range(90 * 70), residual(90 * 70);
  std::vector<std::uint32_t> material(90 * 70);
  Imf::FrameBuffer buffer;
  buffer.insert("range_m", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(range.data()), 4, 4 * 90));
  buffer.insert("range_residual_m",
                Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(residual.data()), 4, 4 * 90));
  buffer.insert("material", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(material.data()), 4, 4 * 90));
  file.setFrameBuffer(buffer);
  file.readPixels(0, 69);
  ASSERT_GT(textures.ranges.size(), 3500u);
  for (std::uint32_t pixel = 0; pixel < 90 * 70; ++pixel) {
    const auto found = textures.ranges.find(pixel);
    if (found == textures.ranges.end()) {
      EXPECT_EQ(material[pixel], 0xffffffffu);
      EXPECT_EQ(range[pixel], 0.0f);
    } else {
      // A float residual of at most 2^-11 m has steps of 2^-35 m.
      EXPECT_NEAR(static_cast<double>(range[pixel]) + static_cast<double>(residual[pixel]), found->second,
                  1e-9);
      EXPECT_EQ(material[pixel], 0u);
    }
  }
}

TEST_F(FrameFilesTest, WhenTheDiskIsFullTheFilesOfTheFrameBeforeStayAndNoPartOfTheNewOne) {
  render_to(folder_);
  const auto before = contents(folder_);
  settings_.azimuth_bins = 90;
  render_frame();
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto heed = std::signal(SIGXFSZ, SIG_IGN);
  // Room for the larger frame's bins.npy (24 kB) or for nothing at all, not for its maps.
  for (const rlim_t bytes : {rlim_t{30000}, rlim_t{1000}}) {
    const rlimit tight{bytes, limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
    std::string said;
    try {
      write_frame_files(folder_, descriptor_, summary_, frame_.bins);
    } catch (const InputError& error) {
      said = error.what();
    }
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    EXPECT_TRUE(said.starts_with((folder_ / "").string())) << said;
    EXPECT_NE(said.find(": cannot be written ("), std::string::npos) << said;
    EXPECT_EQ(said.find(".new"), std::string::npos) << said;
    EXPECT_TRUE(contents(folder_) == before);
  }
  std::signal(SIGXFSZ, heed);
  EXPECT_EQ(write_frame_files(folder_, descriptor_, summary_, frame_.bins).missing, "");
  EXPECT_EQ(contents(folder_).size(), before.size());
}

TEST_F(FrameFilesTest, AFrameOfAPartOfThePlanesHasTheirFilesAndASentenceAboutTheOthers) {
  render_to(folder_);
  const std::map<std::string, std::string> whole = contents(folder_);
  const BinBlock all = frame_.bins;
  for (int planes = 0; planes < 16; ++planes) {
    BinBlock some = all;
    if (!(planes & 1)) some.iq.clear();
    if (!(planes & 2)) some.power_w.clear();
    if (!(planes & 4)) some.count.clear();
    if (!(planes & 8)) some.state.clear();
    const std::string said = write_frame_files(folder_, descriptor_, summary_, some).missing;
    const auto files = contents(folder_);
    int bit = 1;
    for (const std::string name : {"bins.npy", "power.npy", "count.npy", "state.npy"}) {
      const bool there = planes & bit;
      EXPECT_EQ(files.contains(name), there) << planes << " " << name;
      EXPECT_TRUE(!there || files.at(name) == whole.at(name)) << planes << " " << name;
      EXPECT_EQ(said.find(name) == std::string::npos, there) << planes << ": " << said;
      bit *= 2;
    }
    const bool drawn = planes & 3;
    EXPECT_EQ(files.contains("ground_map.png"), drawn) << planes;
    EXPECT_EQ(files.contains("ground_map.tif"), drawn) << planes;
    EXPECT_TRUE(files.contains("frame.json")) << planes;
    EXPECT_EQ(said.empty(), planes == 15) << said;
  }
  EXPECT_TRUE(contents(folder_) == whole);
}

TEST_F(FrameFilesTest, AFolderThatCannotBeWrittenIsNamed) {
  const fs::path blocker = fs::path(testing::TempDir()) / "obliq_a_file";
  std::ofstream(blocker) << "x";
  try {
    prepare_output_folder(blocker / "out");
    FAIL() << "a folder inside a file cannot be made";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("obliq_a_file/out: cannot be made"), std::string::npos)
        << error.what();
  }
}

/// The warnings of a frame over flat ground at sea level of a 4/3 earth, or over a plateau.
std::vector<std::string> warnings_from(double antenna_m, double r_max_m, double plateau_m = 0) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 310000, 4096);
  spec.radius_factor = 4.0 / 3;
  World world = load_world(spec);
  for (float& y : world.grid.y_m) y += static_cast<float>(plateau_m);
  const auto scene = test::make_scene(std::move(world));
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.r_min_m = 4000;
  settings.r_max_m = r_max_m;
  const PlanResult planned =
      plan_frame(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), antenna_m));
  wire::FrameDescriptor descriptor;
  describe_frame(*planned.plan, "main", "test", descriptor);
  return {descriptor.warnings().begin(), descriptor.warnings().end()};
}

TEST(RefractionWarning, ComesWhereTheStandardAtmosphereWouldChangeSomething) {
  // ITU-R P.453: N = 315 exp(-h / 7.35 km) falls by 253.4 over 12 km, 21.1 a km: k = 1 / (1 - 6371
  // x 21.1e-6).
  const std::vector<std::string> high = warnings_from(12000, 300000);
  ASSERT_EQ(high.size(), 1u);
  EXPECT_NE(high[0].find("12000 m above the ground"), std::string::npos) << high[0];
  EXPECT_NE(high[0].find("would be 1.155 here"), std::string::npos) << high[0];
  EXPECT_NE(high[0].find(" dB"), std::string::npos) << high[0];
}

TEST(RefractionWarning, StaysAwayWhereNothingChanges) {
  EXPECT_TRUE(warnings_from(4000, 24500).empty()) << "0.3 m and 0.01 dB at the far edge";
  EXPECT_TRUE(warnings_from(4500, 300000, 2000).empty()) << "2500 m above the plateau";
  EXPECT_FALSE(warnings_from(4500, 300000, 0).empty());
}

TEST_F(FrameFilesTest, ManyLitBinsWithoutASampleAreCountedAndWarnedOf) {
  for (const int pixels : {20, 400}) {
    settings_.pixel_columns = settings_.pixel_rows = pixels;
    settings_.plates = PlateKind::nearest;
    render_to(folder_);
    std::uint64_t lit = 0, unsampled = 0;
    for (const std::uint8_t state : frame_.bins.state) {
      lit += state <= 1 ? 1 : 0;
      unsampled += state == 0 ? 1 : 0;
    }
    const auto summary = nlohmann::json::parse(slurp(folder_ / "frame.json"))["summary"];
    EXPECT_EQ(summary["lit_bins"], lit);
    EXPECT_EQ(summary["unsampled_bins"], unsampled);
    const bool many = static_cast<double>(unsampled) > 0.03 * static_cast<double>(lit);
    EXPECT_EQ(many, pixels == 20);
    ASSERT_EQ(summary["warnings"].size(), many ? 1u : 0u);
    if (!many) continue;
    const std::string warning = summary["warnings"][0];
    EXPECT_NE(warning.find(std::to_string(unsampled) + " of " + std::to_string(lit)), std::string::npos)
        << warning;
    EXPECT_NE(warning.find("frustum.quality = \"standard\""), std::string::npos) << warning;
  }
}

constexpr double kDegree = std::numbers::pi / 180;
/// The document prints millimetres and a thousandth of a micro-degree, 0.1 mm.
constexpr double kPrinted_m = 0.001;
constexpr double kPrinted_deg = 0.6e-9;

using Numbers = std::map<std::string, double>;

/// The lines "name value" between "```kind" and "```".
Numbers block_of_the_protocol_document(const std::string& kind) {
  std::ifstream file(OBLIQ_SOURCE_DIR "/proto/PROTOCOL.md");
  Numbers numbers;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```" + kind;
    } else if (inside) {
      std::istringstream words(line);
      std::string name;
      words >> name >> numbers[name];
    }
  }
  return numbers;
}

struct WorkedBin {
  Numbers given = block_of_the_protocol_document("bin");
  Numbers place = block_of_the_protocol_document("place");

  double bearing_rad() const {
    return (given.at("azimuth_start_deg") + (given.at("azimuth_bin") + 0.5) * given.at("azimuth_width_deg")) *
           kDegree;
  }
  double slant_range_m() const {
    return given.at("range_start_m") + (given.at("range_bin") + 0.5) * given.at("range_spacing_m");
  }
  WorldFrame frame() const {
    return {given.at("origin_latitude_deg") * kDegree, given.at("origin_longitude_deg") * kDegree,
            given.at("radius_factor")};
  }
};

TEST(ProtocolDocument, TheWorkedBinsPlaceIsAtItsSlantRangeAndBearing) {
  const WorkedBin bin;
  ASSERT_EQ(bin.given.size(), 14u);
  ASSERT_EQ(bin.place.size(), 6u);
  const WorldPoint world = bin.frame().world_from_geodetic({bin.place.at("latitude_deg") * kDegree,
                                                            bin.place.at("longitude_deg") * kDegree,
                                                            bin.given.at("map_reference_height_m")});
  EXPECT_NEAR(world.m.x, bin.place.at("x_m"), kPrinted_m);
  EXPECT_NEAR(world.m.y, bin.place.at("y_m"), kPrinted_m);
  EXPECT_NEAR(world.m.z, bin.place.at("z_m"), kPrinted_m);
  const double dx = world.m.x - bin.given.at("antenna_x_m");
  const double dy = world.m.y - bin.given.at("antenna_y_m");
  const double dz = world.m.z - bin.given.at("antenna_z_m");
  EXPECT_NEAR(std::sqrt(dx * dx + dy * dy + dz * dz), bin.slant_range_m(), kPrinted_m);
  EXPECT_NEAR(std::hypot(dx, dz), bin.place.at("ground_range_m"), kPrinted_m);
  EXPECT_NEAR((std::atan2(dx, dz) - bin.given.at("north_rad") - bin.bearing_rad()) * bin.slant_range_m(), 0,
              kPrinted_m);
}

TEST(ProtocolDocument, PicturesPlaceTheWorkedBinThere) {
  const WorkedBin bin;
  const WorldPoint antenna{
      {bin.given.at("antenna_x_m"), bin.given.at("antenna_y_m"), bin.given.at("antenna_z_m")}};
  const Geodetic at = bin.frame().geodetic_from_world(antenna);
  wire::FrameDescriptor descriptor;
  descriptor.mutable_pose()->set_latitude_deg(at.latitude_rad / kDegree);
  descriptor.mutable_pose()->set_longitude_deg(at.longitude_rad / kDegree);
  descriptor.mutable_settings()->set_azimuth_bins(240);
  descriptor.mutable_settings()->set_range_bins(1000);
  // The block's names are the descriptor's, so reflection sets them.
  for (const auto& [name, value] : bin.given) {
    const auto* field = descriptor.GetDescriptor()->FindFieldByName(name);
    if (field) descriptor.GetReflection()->SetDouble(&descriptor, field, value);
  }
  const MapProjection projection(descriptor);
  const auto place = projection.place(bin.bearing_rad(), bin.slant_range_m());
  double latitude_deg, longitude_deg;
  GeographicLib::AzimuthalEquidistant().Reverse(descriptor.pose().latitude_deg(),
                                                descriptor.pose().longitude_deg(), place.east_m,
                                                place.north_m, latitude_deg, longitude_deg);
  EXPECT_NEAR(latitude_deg, bin.place.at("latitude_deg"), kPrinted_deg);
  EXPECT_NEAR(longitude_deg, bin.place.at("longitude_deg"), kPrinted_deg);
}

}  // namespace
}  // namespace obliq::frame_files_test
