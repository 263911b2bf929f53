// Pictures by the real programs: of a stream, with a scale of one's own, placed by the ground's heights.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

class PictureCommands : public testing::Test {
 protected:
  Outcome obliq(const std::vector<std::string>& arguments) const {
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  void refused(const std::vector<std::string>& arguments, const std::string& part) const {
    const Outcome outcome = obliq(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments[0] << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << arguments[0] << ": " << outcome.err;
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", text_of(SmallScene{}));
};

/// Width and height as a PNG's first chunk says them; 0 x 0 for what is none.
std::pair<int, int> size_of_png(const std::filesystem::path& file) {
  const std::string bytes = text_of(file);
  if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG" || bytes.substr(12, 4) != "IHDR") return {0, 0};
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
  };
  return {number(16), number(20)};
}

TEST_F(PictureCommands, WatchKeepsOneWholePictureAndNothingElse) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const std::filesystem::path place = folder / "shown";
  const Outcome watched = obliq({"watch", "--server", daemon.address(), "--rate", "20", "--frames", "3",
                                 "--picture", place / "radar.png", "--picture-side", "900"});
  ASSERT_EQ(watched.code, 0) << watched.err;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(place), {}), 1);
  const auto [width, height] = size_of_png(place / "radar.png");
  EXPECT_GT(std::max(width, height), 900);
  EXPECT_LT(std::max(width, height), 1400);

  const std::vector<std::string> watch = {"watch", "--server", daemon.address(), "--frames", "1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), watch.begin(), watch.end());
    return more;
  };
  refused(with({"--picture", place}), "a folder; allowed: a file");
  refused(with({"--picture", place / "a.png", "--planes", "count"}), "iq, power or video among them");
  refused(with({"--picture", place / "a.png", "--picture-side", "0"}), "100");
  refused(with({"--ortho", "--out", place}), "allowed: with `obliq render`");
  refused({"get", "--server", daemon.address(), "--out", place, "--ortho"}, "allowed: with `obliq render`");
  for (const std::string bad : {"", "30", "30:20", "20:20", "a:b", "0:nan", "0:1e9"})
    refused({"get", "--server", daemon.address(), "--out", place, "--db-range=" + bad},
            bad.empty() ? "--db-range" : "--db-range: found \"" + bad + "\"; allowed: LOW:HIGH in dB");
  EXPECT_EQ(obliq({"get", "--server", daemon.address(), "--out", place, "--db-range", "-20:30"}).code, 0);
}

TEST_F(PictureCommands, RenderPlacesTheMapByTheHeightsOfTheGroundAndSaysSo) {
  ASSERT_EQ(obliq({"render", scene, "--out", folder / "plain"}).code, 0);
  const Outcome ortho = obliq({"render", scene, "--out", folder / "placed", "--ortho"});
  ASSERT_EQ(ortho.code, 0) << ortho.err;
  const std::string plain = text_of(folder / "plain" / "ground_map.tif");
  const std::string placed = text_of(folder / "placed" / "ground_map.tif");
  EXPECT_NE(plain.find("as if all ground lay"), std::string::npos);
  EXPECT_NE(placed.find("by the heights of the ground"), std::string::npos);
  for (const char* same : {"bins.npy", "power.npy", "ground_map.png"})
    EXPECT_TRUE(text_of(folder / "plain" / same) == text_of(folder / "placed" / same)) << same;
}

}  // namespace
}  // namespace obliq::test
