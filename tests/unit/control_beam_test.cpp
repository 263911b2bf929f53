// [beam], [pulse], antenna.tilt_deg and scan.bars in a scene file: what is read, and how mistakes are
// answered.
#include <gtest/gtest.h>

#include <filesystem>

#include "server/control/parameters.h"
#include "server/radar/beam/pattern_cuts.h"
#include "tests/unit/scene_file_fixture.h"

namespace obliq {
namespace {

using BeamInASceneFile = SceneFile;

constexpr auto kSector = "[radar]\nsector_deg = 60\n[bins]\nazimuth = 200\nrange = 100\n";

TEST_F(BeamInASceneFile, IsRead) {
  const SceneConfig config =
      read(std::string(kFlat) + kSector +
           "[beam]\npattern = \"taylor\"\nwidth_deg = 2\nelevation = \"cosecant\"\n[pulse]\nkind = "
           "\"rectangular\"\n"
           "length_us = 3\n[antenna]\ntilt_deg = \"auto\"\n[scan]\nmode = \"sector\"\nbars = [-2, 0, 2.5]\n");
  const RadarConfig& radar = config.radars.front();
  EXPECT_EQ(radar.settings.beam.pattern, BeamPattern::taylor);
  EXPECT_EQ(radar.settings.beam.elevation, ElevationPattern::cosecant);
  EXPECT_EQ(radar.settings.pulse.kind, PulseKind::rectangular);
  EXPECT_TRUE(radar.pose.tilt_auto);
  EXPECT_EQ(radar.settings.scan_bars_deg, (std::vector<double>{-2, 0, 2.5}));
  EXPECT_EQ(resolved_speckle(radar.settings), SpeckleKind::independent);
  RadarSettings whole_frames = radar.settings;
  whole_frames.scan_mode = ScanMode::frame;
  EXPECT_EQ(resolved_speckle(whole_frames), SpeckleKind::ground);
}

TEST_F(BeamInASceneFile, TiltIsANumberOrAuto) {
  const std::string head = std::string(kFlat) + "[antenna]\n";
  EXPECT_EQ(read(head + "tilt_deg = -3.5\n").radars.front().pose.tilt_deg, -3.5);
  EXPECT_TRUE(read(kFlat, {"antenna.tilt_deg=auto"}).radars.front().pose.tilt_auto);
  EXPECT_SAYS(complaint(head + "tilt_deg = \"down\"\n"), "antenna.tilt_deg: found \"down\"; allowed: number");
  EXPECT_SAYS(complaint(head + "tilt_deg = nan\n"), "found nan");
  EXPECT_SAYS(complaint(head + "tilt_deg = 91\n"), "-90 to 90 deg");
}

TEST_F(BeamInASceneFile, PatternFileIsFoundBesideIt) {
  write("cut,angle_deg,gain_db\nazimuth,-4,-30\nazimuth,0,0\nazimuth,4,-30\n", "horn.csv");
  const std::string scene =
      std::string(kFlat) + kSector + "[beam]\nfile = \"horn.csv\"\npattern = \"file\"\n";
  const SceneConfig config = read(scene);
  ASSERT_TRUE(config.radars.front().settings.beam.file);
  EXPECT_EQ(config.radars.front().settings.beam.file->azimuth.angle_rad.size(), 3U);
  EXPECT_SAYS(complaint(scene + "elevation = \"file\"\n"),
              "beam.elevation: found \"file\" without a cut elevation; allowed: a beam.file");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[beam]\nfile = \"no.csv\"\n"), "beam.file: cannot be read");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[beam]\nfile = 5\n"), "beam.file: found 5; allowed: the path");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[beam]\npattern = \"file\"\n"), "without a cut azimuth");
}

TEST_F(BeamInASceneFile, BeamsThatDoNotFitTheirBinsAreRefusedWithWhatWouldDo) {
  const std::string head = std::string(kFlat) + kSector + "[beam]\npattern = \"gaussian\"\nwidth_deg = ";
  EXPECT_EQ(complaint(head + "0.5\n"), "accepted") << "narrower than two bins: sharp bins are cut";
  // 0.3 deg a bin, eight sharp ones in it, two of them a beamwidth: 0.075 deg at least.
  EXPECT_SAYS(complaint(head + "0.05\n"),
              "beam.width_deg: found 0.05 with bins.azimuth = 200; allowed: a beam of at "
              "least 0.25 azimuth bins; bins.azimuth = 300 would do");
  EXPECT_SAYS(complaint(head + "31\n"),
              "beam.width_deg: found 31.0 with radar.sector_deg = 60.0; allowed: at most half");
  EXPECT_SAYS(complaint(head + "nan\n"), "found nan");
  EXPECT_SAYS(complaint(head + "3\nextent_deg = 181\n"), "0 to 180 deg");
}

TEST_F(BeamInASceneFile, PulsesThatDoNotFitTheirBinsAreRefusedWithWhatWouldDo) {
  const std::string head = std::string(kFlat) + kSector + "[pulse]\n";  // 333 m a range bin
  EXPECT_SAYS(complaint(head + "kind = \"compressed\"\nextent_bins = 101\n"),
              "pulse.extent_bins: found 101 with bins.range = 100; allowed: at most as many");
  EXPECT_EQ(complaint(head + "kind = \"compressed\"\nbandwidth_mhz = 3\n"), "accepted");
  EXPECT_SAYS(complaint(head + "kind = \"compressed\"\nbandwidth_mhz = 10\n"),
              "pulse.bandwidth_mhz: found 10.0 with bins.range = 100");
  EXPECT_SAYS(complaint(head + "kind = \"compressed\"\nbandwidth_mhz = 10\n"), "bins.range = 278 would do");
  EXPECT_SAYS(complaint(head + "kind = \"rectangular\"\nlength_us = 100\n"),
              "pulse.extent_bins: found 16 with pulse.length_us = 100.0; allowed: at least 46");
  EXPECT_SAYS(complaint(head + "kind = \"rectangular\"\nlength_us = 1000\n"),
              "pulse.length_us: found 1000.0; allowed: at most 222.15, as long as the swath");
  EXPECT_SAYS(
      complaint(head + "kind = \"compressed\"\nbandwidth_mhz = 0.4\nlength_us = 2\n"),
      "pulse.bandwidth_mhz: found 0.4 with pulse.length_us = 2.0; allowed: at least 1 / pulse.length_us");
  // 2 A^2 + 1/2, cosh(pi A) = 1000: 12.2 (Taylor 1955).
  EXPECT_SAYS(complaint(head + "kind = \"compressed\"\nwindow = \"taylor\"\nsidelobe_db = 60\nnbar = 12\n"),
              "pulse.nbar: found 12 with pulse.sidelobe_db = 60.0; allowed: at least 13");
  EXPECT_EQ(complaint(head + "kind = \"compressed\"\nwindow = \"taylor\"\nsidelobe_db = 60\nnbar = 13\n"),
            "accepted");
  for (const char* key : {"length_us", "bandwidth_mhz", "sidelobe_db"})
    EXPECT_SAYS(complaint(head + key + " = nan\n"), "found nan");
}

TEST_F(BeamInASceneFile, BarsAreTilts) {
  const std::string head = std::string(kFlat) + "[scan]\nbars = ";
  EXPECT_NE(complaint(head + "[91]\n"), "accepted");
  EXPECT_NE(complaint(head + "[]\n"), "accepted");
  EXPECT_NE(complaint(head + "[\"up\"]\n"), "accepted");
  EXPECT_SAYS(complaint(head + "[nan]\n"), "scan.bars");
}

}  // namespace
}  // namespace obliq
