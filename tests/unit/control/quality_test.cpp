// frustum.quality in every layer, and [accuracy].
// [beam], [pulse], antenna.tilt_deg and scan.bars in a scene file: what is read, and how mistakes are
// answered.
// What the process says of its own memory. The oracle is what was allocated and touched.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "server/control/parameters.h"
#include "server/control/quality_presets.h"
#include "server/control/scene_file.h"
#include "server/radar/beam/pattern_cuts.h"
#include "terrain/base/process.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::quality_test {
namespace {

class Quality : public SceneFile {
 protected:
  RadarSettings settings(const std::string& text, const std::vector<std::string>& set = {}) {
    return read(std::string(kFlat) + text, set).radars[0].settings;
  }
};

TEST_F(Quality, PaperIsThePapersSamplingWhateverTheBins) {
  const RadarSettings s = settings("[frustum]\nquality = \"paper\"\n[bins]\nazimuth = 64\nrange = 32\n");
  EXPECT_EQ(s.frustum, FrustumKind::oblique);
  EXPECT_EQ(s.plates, PlateKind::nearest);
  EXPECT_EQ(s.pixel_columns, 2048);
  EXPECT_EQ(s.pixel_rows, 2048);
}

TEST_F(Quality, NoFrustumAtAllMeansStandardAndIsSaid) {
  const SceneConfig config = read(kFlat);
  const RadarSettings standard = settings("[frustum]\nquality = \"standard\"\n");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::sweep);
  EXPECT_EQ(config.radars[0].settings.pixel_columns, standard.pixel_columns);
  ASSERT_EQ(config.notes.size(), 1u);
  EXPECT_EQ(config.notes[0],
            "no frustum named: sweep \"standard\"; frustum.kind = \"oblique\" casts rays with Embree");
  EXPECT_EQ(settings("[frustum]\n").frustum, FrustumKind::sweep) << "an empty table names nothing";
  EXPECT_EQ(settings("[bins]\nazimuth = 64\n").pixel_columns, 128);
  EXPECT_EQ(settings("[bins]\nazimuth = 64\n", {"bins.azimuth=32"}).pixel_columns, 64);
}

TEST_F(Quality, PixelsOrPlatesAloneMeanTheObliqueFrustumAndThatIsSaid) {
  for (const std::string key :
       {"pixels = 300", "pixel_columns = 300", "pixel_rows = 300", "plates = \"nearest\""}) {
    const SceneConfig config = read(std::string(kFlat) + "[frustum]\n" + key + "\n");
    EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::oblique) << key;
    ASSERT_EQ(config.notes.size(), 1u) << key;
    EXPECT_NE(config.notes[0].find("frustum.kind is not named: \"oblique\""), std::string::npos)
        << config.notes[0];
  }
  EXPECT_EQ(read(kFlat, {"frustum.pixels=300"}).radars[0].settings.frustum, FrustumKind::oblique);
  EXPECT_EQ(read(std::string(kFlat) + "[frustum]\nkind = \"symmetric\"\n").notes.size(), 0u);
  EXPECT_EQ(read(std::string(kFlat) + "[frustum]\npixels = 300\n", {"frustum.quality=draft"}).notes.size(),
            0u);
}

TEST_F(Quality, OfSeveralRadarsThoseWithoutAFrustumAreNamed) {
  const SceneConfig config = read(std::string(kFlat) + "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\n" +
                                  "frustum.kind = \"oblique\"\n[[radar]]\nname = \"c\"\n");
  EXPECT_EQ(config.radars[0].settings.frustum, FrustumKind::sweep);
  EXPECT_EQ(config.radars[1].settings.frustum, FrustumKind::oblique);
  ASSERT_EQ(config.notes.size(), 1u);
  EXPECT_EQ(config.notes[0].rfind("radar a, c: no frustum named", 0), 0u) << config.notes[0];
}

TEST_F(Quality, ObliqueIsToFindItsPixelsUnlessTheyAreNamed) {
  const std::string quality = "[frustum]\nquality = \"oblique\"\n";
  const RadarConfig radar = read(std::string(kFlat) + quality).radars[0];
  EXPECT_EQ(radar.settings.frustum, FrustumKind::oblique);
  EXPECT_EQ(radar.settings.plates, PlateKind::spread);
  EXPECT_TRUE(radar.finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality + "pixels = 300\n").radars[0].finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality, {"frustum.pixels=300"}).radars[0].finds_pixels);
  EXPECT_FALSE(read(std::string(kFlat) + quality, {"frustum.kind=symmetric"}).radars[0].finds_pixels);
  EXPECT_TRUE(read(kFlat, {"frustum.quality=oblique"}).radars[0].finds_pixels);
  EXPECT_FALSE(
      read(std::string(kFlat) + quality + "[[radar]]\nfrustum.pixels = 300\n").radars[0].finds_pixels);
  const std::string printed = print_config(read(std::string(kFlat) + quality));
  EXPECT_NE(printed.find("quality = \"oblique\""), std::string::npos) << printed;
  EXPECT_TRUE(read(printed).radars[0].finds_pixels) << "what is printed can be read again";
}

TEST_F(Quality, TheOthersFollowTheBinsWhereverTheseAreSet) {
  const QualityPreset* standard = find_quality("standard");
  ASSERT_NE(standard, nullptr);
  const auto expected = [&](int azimuth_bins) {
    return static_cast<int>(std::lround(standard->columns_per_bin * azimuth_bins));
  };
  const std::string quality = "[frustum]\nquality = \"standard\"\n";
  EXPECT_EQ(settings(quality).pixel_columns, expected(1024));  // the default number of bins
  EXPECT_EQ(settings(quality + "[bins]\nazimuth = 100\n").pixel_columns, expected(100));
  EXPECT_EQ(settings(quality + "[bins]\nazimuth = 100\n", {"bins.azimuth=300"}).pixel_columns, expected(300));
  EXPECT_EQ(settings("[radar]\nfrustum.quality = \"standard\"\nbins.azimuth = 50\n").pixel_columns,
            expected(50));
  // 16 x 8192 columns would be too many.
  EXPECT_LE(settings("[frustum]\nquality = \"reference\"\n[bins]\nazimuth = 8192\n").pixel_columns, 16384);
}

TEST_F(Quality, EachRadarHasTheBinsOfItsOwn) {
  const SceneConfig config = read(std::string(kFlat) +
                                  "[frustum]\nquality = \"draft\"\n[bins]\nazimuth = 40\n"
                                  "[[radar]]\nname = \"a\"\n[[radar]]\nname = \"b\"\nbins.azimuth = 60\n"
                                  "[[radar]]\nname = \"c\"\nfrustum.pixel_columns = 7\n");
  const double per_bin = find_quality("draft")->columns_per_bin;
  EXPECT_EQ(config.radars[0].settings.pixel_columns, std::lround(40 * per_bin));
  EXPECT_EQ(config.radars[1].settings.pixel_columns, std::lround(60 * per_bin));
  EXPECT_EQ(config.radars[2].settings.pixel_columns, 7);
}

TEST_F(Quality, KeysOfTheSameLayerWin) {
  const RadarSettings file =
      settings("[frustum]\nkind = \"symmetric\"\nquality = \"draft\"\npixels = [30, 20]\n");
  EXPECT_EQ(file.frustum, FrustumKind::symmetric);
  EXPECT_EQ(file.pixel_columns, 30);
  EXPECT_EQ(file.pixel_rows, 20);
  for (const auto& flags : {std::vector<std::string>{"frustum.quality=draft", "frustum.kind=symmetric"},
                            std::vector<std::string>{"frustum.kind=symmetric", "frustum.quality=draft"}})
    EXPECT_EQ(settings("", flags).frustum, FrustumKind::symmetric) << flags[0];
}

TEST_F(Quality, ALaterLayerWinsOverTheKeysOfAnEarlierOne) {
  // A scene that names its frustum can still be tried at another quality.
  const std::string scene = "[frustum]\nkind = \"symmetric\"\npixels = 300\n";
  const RadarSettings s = settings(scene, {"frustum.quality=paper"});
  EXPECT_EQ(s.frustum, FrustumKind::oblique);
  EXPECT_EQ(s.pixel_columns, 2048);
  setenv("OBLIQ_FRUSTUM_QUALITY", "paper", 1);
  setenv("OBLIQ_FRUSTUM_PIXEL_ROWS", "90", 1);
  const RadarSettings by_environment = settings(scene);
  const RadarSettings by_flag = settings(scene, {"frustum.plates=spread"});
  unsetenv("OBLIQ_FRUSTUM_QUALITY");
  unsetenv("OBLIQ_FRUSTUM_PIXEL_ROWS");
  EXPECT_EQ(by_environment.frustum, FrustumKind::oblique);
  EXPECT_EQ(by_environment.plates, PlateKind::nearest);
  EXPECT_EQ(by_environment.pixel_columns, 2048);
  EXPECT_EQ(by_environment.pixel_rows, 90);
  EXPECT_EQ(by_flag.plates, PlateKind::spread);
}

TEST_F(Quality, AnUnknownOneIsRefusedWithTheNames) {
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nquality = \"best\"\n"), "frustum.quality");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nquality = 3\n"), "\"reference\"");
  EXPECT_SAYS(complaint(kFlat, {"frustum.quality=ultra"}), "frustum.quality");
}

TEST_F(Quality, PrintConfigShowsWhatItBecame) {
  const std::string text =
      print_config(read(std::string(kFlat) + "[frustum]\nquality = \"paper\"\n[bins]\nazimuth = 64\n"));
  EXPECT_EQ(text.find("\nquality = "), std::string::npos);
  EXPECT_NE(text.find("plates = \"nearest\""), std::string::npos) << text;
}

TEST_F(Quality, AccuracyIsAnyUnlessAsked) {
  EXPECT_FALSE(read(kFlat).accuracy.asks());
  const SceneConfig config =
      read(std::string(kFlat) + "[accuracy]\nmax_power_error_db = 0.2\n", {"accuracy.max_gap_fraction=0.01"});
  EXPECT_TRUE(config.accuracy.asks());
  EXPECT_EQ(config.accuracy.max_power_error_db, 0.2);
  EXPECT_EQ(config.accuracy.max_gap_fraction, 0.01);
  // An error alone is meant for nearly all bins; 1 asks for no limit, in so many words.
  EXPECT_EQ(read(kFlat).accuracy.max_gap_fraction, 1);
  EXPECT_EQ(read(kFlat, {"accuracy.max_power_error_db=0.5"}).accuracy.max_gap_fraction, 0.05);
  EXPECT_EQ(read(kFlat, {"accuracy.max_power_error_db=0.5", "accuracy.max_gap_fraction=1"})
                .accuracy.max_gap_fraction,
            1);
  EXPECT_SAYS(complaint(kFlat, {"main:accuracy.max_gap_fraction=0.1"}), "no radar parameter");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[accuracy]\nmax_gap_fraction = 2\n"),
              "accuracy.max_gap_fraction");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[accuracy]\nmax_power_error_db = -1\n"),
              "accuracy.max_power_error_db");
}

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
  EXPECT_EQ(complaint(head + "[]\n"), "accepted");
  EXPECT_NE(complaint(head + "[\"up\"]\n"), "accepted");
  EXPECT_SAYS(complaint(head + "[nan]\n"), "scan.bars");
}

constexpr std::size_t kBlock_bytes = 300'000'000;

void touch_and_give_back() {
  void* block = ::mmap(nullptr, kBlock_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  std::memset(block, 1, kBlock_bytes);
  ::munmap(block, kBlock_bytes);
}

TEST(ProcessMemory, ThePeakRemembersMemoryThatWasGivenBack) {
  touch_and_give_back();
  EXPECT_GT(peak_resident_bytes(), std::int64_t{kBlock_bytes});
  EXPECT_LT(resident_bytes(), std::int64_t{kBlock_bytes});
}

TEST(ProcessMemory, LargePagesAreThereWhereTheKernelGivesThemToAllOrToWhatAsks) {
  const auto gives = [](const char* setting) {
    const std::string file = testing::TempDir() + "enabled";
    std::ofstream(file) << setting << '\n';
    return gives_large_pages(file);
  };
  EXPECT_TRUE(gives("[always] madvise never"));
  EXPECT_TRUE(gives("always [madvise] never"));
  EXPECT_FALSE(gives("always madvise [never]"));
  EXPECT_FALSE(gives_large_pages("/no/such/file"));
}

// getrusage's ru_maxrss would say 300 MB here: a new process takes it over from its parent.
TEST(ProcessMemory, ThePeakOfTheParentIsNotThatOfItsChild) {
  touch_and_give_back();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::int64_t peak = peak_resident_bytes();
    ::_exit(peak > 0 && peak < std::int64_t{kBlock_bytes} / 2 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the child's peak counts its parent's memory";
}

}  // namespace
}  // namespace obliq::quality_test
