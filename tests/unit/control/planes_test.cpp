// frustum.planes_per_bin: in every layer of a scene file, in requests, and what is too much.
#include <gtest/gtest.h>

#include <algorithm>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/planes_per_bin.h"
#include "server/control/settings_message.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::planes_test {
namespace {

class Planes : public SceneFile {
 protected:
  RadarSettings settings(const std::string& text, const std::vector<std::string>& set = {}) {
    return read(kFlat + text, set).radars[0].settings;
  }
  /// "PLANES COLUMNS".
  std::string of(const std::string& text, const std::vector<std::string>& set = {}) {
    const RadarSettings s = settings(text, set);
    return std::to_string(s.planes_per_bin) + " " + std::to_string(s.pixel_columns);
  }
};

constexpr auto kBins = "[bins]\nazimuth = 100\n";

TEST_F(Planes, FollowTheQualityWhereNothingNamesThem) {
  EXPECT_EQ(of(kBins), "2 200");
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nquality = \"draft\"\n"), "1 100");
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nquality = \"reference\"\n"), "8 800");
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nquality = \"reference\"\nplanes_per_bin = 0\n"), "8 800");
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nquality = \"paper\"\n"), "0 2048") << "rays have pixels";
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nkind = \"sweep\"\n"), "21 2100")
      << "the bits that it always had: those of 2048 columns";
  EXPECT_EQ(of("[frustum]\nquality = \"reference\"\n[bins]\nazimuth = 3000\n"), "6 16384")
      << "as many as before";
}

TEST_F(Planes, AloneAreThoseOfTheSweep) {
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nplanes_per_bin = 5\n"), "5 500");
  EXPECT_EQ(of(kBins, {"frustum.planes_per_bin=4"}), "4 400");
  EXPECT_EQ(settings("[frustum]\nplanes_per_bin = 5\n").frustum, FrustumKind::sweep);
  EXPECT_EQ(settings("[frustum]\nplanes_per_bin = 0\n").planes_per_bin, 2);
}

TEST_F(Planes, DecideWhereColumnsAreNotNamedInTheSameLayerOrALaterOne) {
  const std::string own = std::string(kBins) + "[frustum]\nquality = \"standard\"\n";
  EXPECT_EQ(of(own + "planes_per_bin = 5\n"), "5 500");
  EXPECT_EQ(of(own + "planes_per_bin = 5\npixel_columns = 300\n"), "0 300") << "named beside it";
  EXPECT_EQ(of(own + "pixel_columns = 300\n"), "0 300");
  EXPECT_EQ(of(own + "pixel_columns = 300\n", {"frustum.planes_per_bin=3"}), "3 300");
  EXPECT_EQ(of(own + "pixel_columns = 300\n", {"frustum.planes_per_bin=4"}), "4 400");
  EXPECT_EQ(of(own + "planes_per_bin = 5\n", {"frustum.pixel_columns=700"}), "0 700");
  EXPECT_EQ(of(own + "planes_per_bin = 5\n", {"frustum.quality=draft"}), "1 100")
      << "a flag's quality beats the file";
  EXPECT_EQ(of(own + "planes_per_bin = 5\n", {"bins.azimuth=32"}), "5 160");
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nkind = \"sweep\"\nplanes_per_bin = 3\n"), "3 300");
  EXPECT_EQ(
      of(std::string(kBins) + "[frustum]\nquality = \"standard\"\n[radar]\nfrustum.pixel_columns = 300\n"),
      "0 300")
      << "a radar's own columns beat the quality of all";
  EXPECT_EQ(of(std::string(kBins) + "[frustum]\nkind = \"oblique\"\nplanes_per_bin = 3\npixels = 512\n"),
            "0 512");
}

TEST_F(Planes, APrintedSceneIsTheSame) {
  for (const std::string frustum : {"quality = \"standard\"", "kind = \"sweep\"\npixel_columns = 300",
                                    "quality = \"paper\"", "kind = \"sweep\"\nplanes_per_bin = 7"}) {
    const SceneConfig first = read(kFlat + std::string(kBins) + "[frustum]\n" + frustum + "\n");
    const SceneConfig again = read(print_config(first));
    for (const Parameter& parameter : parameters())
      EXPECT_EQ(value_of(parameter, again.radars[0]), value_of(parameter, first.radars[0]))
          << parameter.key.name << " of " << frustum;
  }
}

TEST_F(Planes, TooManyAreRefusedWithTheMostThatThereMayBe) {
  EXPECT_SAYS(complaint(std::string(kFlat) +
                        "[frustum]\nquality = \"standard\"\nplanes_per_bin = 3\n[bins]\nazimuth = 8192\n"),
              "FILE:5: frustum.planes_per_bin: found 3 with bins.azimuth = 8192; allowed: at most 2: 16384 "
              "planes in all");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nplanes_per_bin = 2000\n"),
              "allowed: integer 0 to 1024");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nkind = \"sweep\"\nplanes_per_bin = -1\n"),
              "allowed: integer 0 to 1024");
  EXPECT_SAYS(complaint(std::string(kFlat) + "[frustum]\nplanes_per_bin = \"two\"\npixel_columns = 3\n"),
              "frustum.planes_per_bin: found \"two\"");
}

struct Case {
  const char* text;  ///< of the request
  const char* planes_and_columns;
};

/// A sweep of 100 bins with 2 planes each, and what requests make of it.
class PlanesOfRequests : public testing::TestWithParam<Case> {};

TEST_P(PlanesOfRequests, ColumnsAreThoseOfTheRequestOrFollow) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.azimuth_bins = 100;
  s.planes_per_bin = 2;
  s.pixel_columns = 200;
  wire::RadarSettings message;
  const std::string text = GetParam().text;
  if (text.find("bins") != std::string::npos) message.set_azimuth_bins(32);
  if (text.find("columns") != std::string::npos) message.set_pixel_columns(200);
  if (text.find("planes") != std::string::npos)
    message.set_planes_per_bin(text.find("none") != std::string::npos ? 0 : 4);
  if (text.find("range") != std::string::npos) message.set_r_max_m(9000);
  if (text.find("rays") != std::string::npos) message.set_frustum(wire::OBLIQUE);
  EXPECT_TRUE(merge_request(message, s).empty());
  EXPECT_EQ(std::to_string(s.planes_per_bin) + " " + std::to_string(s.pixel_columns),
            GetParam().planes_and_columns);
}

INSTANTIATE_TEST_SUITE_P(All, PlanesOfRequests,
                         testing::Values(Case{"range", "2 200"}, Case{"bins", "2 64"},
                                         Case{"bins planes", "4 128"}, Case{"planes", "4 400"},
                                         Case{"bins columns", "0 200"}, Case{"bins columns planes", "0 200"},
                                         Case{"columns", "0 200"}, Case{"planes none", "0 200"},
                                         Case{"rays bins", "2 200"}),
                         [](const auto& one) {
                           std::string name = one.param.text;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

TEST(PlanesOfRequests, ARequestOfWholeSettingsArrivesAtTheSame) {
  for (const int planes : {0, 2}) {
    RadarSettings s;
    s.frustum = FrustumKind::sweep;
    s.azimuth_bins = 100;
    s.planes_per_bin = planes;
    s.pixel_columns = 200;
    wire::RadarSettings message;
    write_request(s, message);
    RadarSettings arrived;
    EXPECT_TRUE(merge_request(message, arrived).empty());
    EXPECT_EQ(arrived.planes_per_bin, planes);
    EXPECT_EQ(arrived.pixel_columns, 200);
    RadarSettings as_state;
    wire::RadarSettings state;
    write_message(s, state);
    EXPECT_TRUE(merge_message(state, as_state).empty());
    EXPECT_EQ(as_state.planes_per_bin, planes) << "what a descriptor says stays";
    EXPECT_TRUE(state.has_pixel_columns()) << "for clients of 1.1";
  }
}

}  // namespace
}  // namespace obliq::planes_test
