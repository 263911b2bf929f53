// What obliq replay makes of a recording: video of I&Q, a track of poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <sstream>

#include "tests/integration/record_fixture.h"

namespace obliq::test {
namespace {

TEST_F(RecordTest, VideoFollowsFromTheIqThatWasRecorded) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--planes", "iq"})).code, 0);
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  for (const std::string bits : {"8", "16"}) {
    for (const std::string& server : {daemon.address(), address}) {
      const Outcome watched = obliq({"watch", "--server", server, "--radar", "main", "--planes", "video",
                                     "--video-bits", bits, "--frames", "1", "--rate", "20", "--out",
                                     folder / (server == address ? "replayed" : "live")});
      ASSERT_EQ(watched.code, 0) << watched.err << replay.log();
    }
    const std::string live = text_of(folder / "live" / "video.npy");
    EXPECT_FALSE(live.empty());
    EXPECT_TRUE(live == text_of(folder / "replayed" / "video.npy")) << bits;
  }
  EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
}

TEST_F(RecordTest, TheTrackOfARecordingIsFlownAgain) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::string track =
      folder.write("flown.csv",
                   "0,33.0,-99.5,1500,20\n1,33.01,-99.49,1600,60\n1.5,33.01,-99.49,1600,60\n"
                   "2,33.02,-99.5,1550,-10\n");
  Running recorder({"record", "--server", daemon.address(), "--radar", "main", "--out", file, "--rate", "20",
                    "--seconds", "60"},
                   folder / "record.log");
  await_size(file, 1000, recorder);
  ASSERT_EQ(obliq({"fly", track, "--server", daemon.address(), "--radar", "main"}).code, 0);
  // The radar follows the track a moment later: until what was flown last is recorded, too.
  const std::string out = folder / "track.csv";
  const auto last_latitude = [&] {
    const Outcome written = obliq({"replay", file, "--track", out});
    EXPECT_EQ(written.code, 0) << written.err;
    EXPECT_NE(written.out.find(" poses of radar main over "), std::string::npos) << written.out;
    const std::string text = text_of(out);
    double time_s = 0, latitude_deg = 0;
    (void)std::sscanf(text.c_str() + text.rfind('\n', text.size() - 2) + 1, "%lf,%lf", &time_s,
                      &latitude_deg);
    return latitude_deg;
  };
  while (last_latitude() < 33.02 - 1e-9 && !recorder.has_ended()) {
  }
  EXPECT_EQ(recorder.end(SIGINT), 0) << recorder.log();

  std::istringstream lines(text_of(out));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.find("time,latitude,longitude,height,bearing,"), 0u) << line;
  double last_s = -1, latitude = 0, longitude = 0, height = 0, bearing = 0;
  int points = 0;
  while (std::getline(lines, line)) {
    double time_s = 0;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &time_s, &latitude, &longitude, &height, &bearing),
        5)
        << line;
    EXPECT_GT(time_s, last_s);
    last_s = time_s;
    ++points;
    // On the way: longitude and height follow from the latitude.
    if (latitude <= 33.01) {
      EXPECT_NEAR(longitude, -99.5 + (latitude - 33.0), 1e-6) << line;
      EXPECT_NEAR(height, 1500 + (latitude - 33.0) * 10000, 0.01) << line;
    }
  }
  EXPECT_GT(points, 5);
  EXPECT_NEAR(latitude, 33.02, 1e-9);
  EXPECT_NEAR(longitude, -99.5, 1e-9);
  EXPECT_NEAR(height, 1550, 1e-3);
  EXPECT_NEAR(bearing, -10, 1e-6);
  // It is what fly reads, to the same end.
  const Outcome flown =
      obliq({"fly", out, "--server", daemon.address(), "--radar", "main", "--speed", "100"});
  EXPECT_EQ(flown.code, 0) << flown.err;
  EXPECT_EQ(obliq({"replay", file, "--track", folder / "no" / "where.csv"}).code, 1);
}

TEST_F(RecordTest, TheTrackOfAScanningAntennaHasAPoseForEachDwellThatMoved) {
  folder.write("scene.toml", text_of(SmallScene{.server = "[scan]\nmode = \"sector\"\nrate_deg_s = 240.0\n"
                                                          "dwell_bins = 8\n"}));
  const Daemon daemon({"--config", scene}, folder.path());
  Running recorder({"record", "--server", daemon.address(), "--out", file, "--seconds", "60"},
                   folder / "record.log");
  await_size(file, 1000, recorder);
  ASSERT_EQ(obliq({"fly", folder.write("t.csv", "0,33.0,-99.5,1500,20\n1,33.01,-99.5,1500,20\n"), "--server",
                   daemon.address()})
                .code,
            0);
  EXPECT_EQ(recorder.end(SIGINT), 0) << recorder.log();
  const Outcome written = obliq({"replay", file, "--track", "-"});
  ASSERT_EQ(written.code, 0) << written.err;
  // A second has four passes of five dwells; frames alone would be four lines.
  EXPECT_GT(std::ranges::count(written.out, '\n'), 8) << written.out;
}

}  // namespace
}  // namespace obliq::test
