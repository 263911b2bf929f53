// Labels through obliq record and obliq replay.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>

#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/record_fixture.h"

namespace obliq::test::labels_test {
namespace {

TEST_F(RecordTest, LabelsAreRecordedAndReplayedToFilesAndToClients) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::string planes = "power,material,building,height,returns";
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--planes", planes})).code, 0);
  ASSERT_EQ(obliq({"replay", file, "--speed", "max", "--out", folder / "replayed"}).code, 0);
  ASSERT_EQ(obliq({"get", "--server", daemon.address(), "--radar", "main", "--planes", planes, "--out",
                   folder / "got"})
                .code,
            0);
  for (const char* plane : {"power", "material", "building", "height", "returns"}) {
    const std::string name = std::string(plane) + ".npy";
    EXPECT_GT(text_of(folder / ("got/" + name)).size(), 1000u) << name;
    EXPECT_TRUE(text_of(folder / ("replayed/" + name)) == text_of(folder / ("got/" + name))) << name;
  }
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  client::Client client = connected(replay.await(" on "));
  client::FrameAssembler frames(wire::kLabelPlanes);
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 10, wire::kLabelPlanes).ok());
  while (frames.state() != client::FrameAssembler::State::complete) ASSERT_TRUE(client.receive(kLong).ok());
  const client::AssembledFrame frame = frames.take();
  const std::string got = text_of(folder / "got/height.npy");
  ASSERT_LT(frame.height_m.size() * sizeof(float), got.size());
  EXPECT_EQ(
      std::memcmp(frame.height_m.data(), got.data() + got.size() - frame.height_m.size() * sizeof(float),
                  frame.height_m.size() * sizeof(float)),
      0);
  EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
}

}  // namespace
}  // namespace obliq::test::labels_test
