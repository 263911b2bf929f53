// `obliq cat240` against a real daemon: what a receiver gets is the radar's video.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <map>
#include <vector>

#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"
#include "terrain/base/files.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"
#include "tests/support/loopback.h"

namespace obliq::test::cat240_test {
namespace {

/// A video or summary message, read as edition 1.3 says.
struct Message {
  bool summary = false;
  std::string text;
  std::uint32_t index = 0;
  std::uint16_t start_az = 0, end_az = 0;
  std::uint32_t start_rg = 0, cell_dur = 0;
  std::vector<std::uint16_t> cells;
};

class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    to = "127.0.0.1:" + std::to_string(bind_to_loopback(socket_.get()));
    const int large = 8 << 20;  // everything waits here until the command has ended
    (void)setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &large, sizeof large);
    const timeval patience{60, 0};
    (void)setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }

  Message receive() {
    std::vector<std::uint8_t> bytes(65536);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    Message message;
    if (size < 8) {
      ADD_FAILURE() << "nothing came";
      return message;
    }
    const auto at = [&](std::size_t from, std::size_t octets) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < octets; ++i) value = value << 8 | bytes[from + i];
      return value;
    };
    EXPECT_EQ(at(0, 1), 240u);
    EXPECT_EQ(at(1, 2), size);
    message.summary = at(7, 1) == 1;
    if (message.summary) {
      EXPECT_EQ(at(3, 2), 0xD108u);
      message.text.assign(bytes.begin() + 9, bytes.begin() + 9 + bytes[8]);
      return message;
    }
    EXPECT_EQ(at(3, 2), 0xE7A8u);
    message.index = at(8, 4);
    message.start_az = static_cast<std::uint16_t>(at(12, 2));
    message.end_az = static_cast<std::uint16_t>(at(14, 2));
    message.start_rg = at(16, 4);
    message.cell_dur = at(20, 4);
    const std::size_t octets = at(25, 1) == 5 ? 2 : 1;
    for (std::size_t k = 0; k < at(28, 3); ++k)
      message.cells.push_back(static_cast<std::uint16_t>(at(32 + octets * k, octets)));
    return message;
  }
  /// Until the next would have to be waited for.
  std::vector<Message> all() {
    std::vector<Message> messages;
    char none = 0;
    while (recv(socket_.get(), &none, 1, MSG_PEEK | MSG_DONTWAIT) >= 0) messages.push_back(receive());
    return messages;
  }

  std::string to;

 private:
  UniqueFd socket_;
};

class Cat240Command : public ProgramTest {
 protected:
  Outcome cat240(const std::vector<std::string>& more) const { return obliq({"cat240"}, more); }
  Receiver receiver;
};

client::AssembledFrame video_of(const std::string& address, int bits) {
  client::Client client = connected(address);
  client::FrameAssembler frames(wire::plane_bit(wire::Plane::video));
  client.set_handler(&frames);
  wire::Subscribe request;
  request.set_radar("main");
  request.set_rate_hz(20);
  request.add_planes(wire::VIDEO);
  request.set_video_bits(static_cast<std::uint32_t>(bits));
  EXPECT_TRUE(client.subscribe(request).ok());
  while (frames.state() != client::FrameAssembler::State::complete) {
    if (!client.receive(kLong).ok()) {
      ADD_FAILURE();
      break;
    }
  }
  return frames.take();
}

TEST_F(Cat240Command, AReceiverGetsTheVideoOfAStandingRadarBinForBin) {
  const std::string scene = folder.write(
      "scene.toml", text_of(SmallScene{.antenna = "bearing_deg = 20.0\n", .radars = kTwoRadars}));
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  for (const int bits : {8, 16}) {
    const client::AssembledFrame frame = video_of(daemon.address(), bits);
    const Outcome outcome = cat240({daemon.address(), "--radar", "main", "--to", receiver.to, "--frames", "2",
                                    "--rate", "20", "--bits", std::to_string(bits), "--max-datagram", "99"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("UDP is not protected"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find(" to " + receiver.to + " (unicast), levels of " + std::to_string(bits)),
              std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("2 frames, 72 radials, 73 datagrams sent, 0 could not be sent"),
              std::string::npos)
        << outcome.out;
    const std::vector<Message> messages = receiver.all();
    ASSERT_EQ(messages.size(), 73u);
    EXPECT_TRUE(messages[0].summary) << "the first is the summary";
    EXPECT_EQ(messages[0].text.find("main; floor "), 0u) << messages[0].text;
    EXPECT_NE(messages[0].text.find("; 0 no return; range offset "), std::string::npos) << messages[0].text;
    const wire::FrameDescriptor& descriptor = *frame.descriptor;
    for (std::size_t i = 1; i < messages.size(); ++i) {
      const Message& got = messages[i];
      const std::size_t azimuth = (i - 1) % 36;
      EXPECT_EQ(got.index, i - 1);
      if (azimuth > 0) {
        EXPECT_EQ(got.start_az, messages[i - 1].end_az) << "neighbours meet";
      }
      const double left_deg =
          descriptor.azimuth_start_deg() + static_cast<double>(azimuth) * descriptor.azimuth_width_deg();
      EXPECT_NEAR(std::remainder(got.start_az * 360.0 / 65536 - left_deg, 360.0), 0, 360.0 / 65536);
      EXPECT_NEAR(got.cell_dur * 1e-15 * 299792458.0 / 2, descriptor.range_spacing_m(), 1e-6);
      EXPECT_NEAR(got.start_rg * descriptor.range_spacing_m(), descriptor.range_start_m(),
                  descriptor.range_spacing_m() / 2);
      const std::vector<std::uint16_t> expected(
          frame.video.begin() + static_cast<std::ptrdiff_t>(azimuth * 32),
          frame.video.begin() + static_cast<std::ptrdiff_t>(azimuth * 32 + 32));
      EXPECT_EQ(got.cells, expected) << azimuth;
    }
    EXPECT_GT(*std::max_element(frame.video.begin(), frame.video.end()), 0);
  }
}

TEST_F(Cat240Command, ThePassesOfAScanningAntennaComeInTheOrderOfTheBeam) {
  const std::string scene = folder.write(
      "scene.toml",
      text_of(SmallScene{.server = "[scan]\nmode = \"sector\"\nrate_deg_s = 240.0\ndwell_bins = 8\n"}));
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome outcome = cat240({daemon.address(), "--to", receiver.to, "--frames", "4"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  int up = 0, down = 0;
  std::optional<Message> before;
  std::uint32_t next = 0;
  for (const Message& got : receiver.all()) {
    if (got.summary) continue;
    EXPECT_EQ(got.index, next++);
    if (before && got.start_az == before->end_az) ++up;
    if (before && got.end_az == before->start_az) ++down;
    before = got;
  }
  // 36 bins a pass, to the right and back; a machine that is busy may miss dwells.
  EXPECT_GE(up, 7);
  EXPECT_GE(down, 7);
}

TEST_F(Cat240Command, TheRecordedPassesOfAScanningAntennaAreSentAgain) {
  const std::string scene = folder.write(
      "scene.toml",
      text_of(SmallScene{.server = "[scan]\nmode = \"sector\"\nrate_deg_s = 240.0\ndwell_bins = 8\n"}));
  const std::string file = folder / "passes.obliq";
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(
        obliq({"record", "--server", daemon.address(), "--out", file, "--frames", "4", "--planes", "iq"})
            .code,
        0);
  }
  Running replay({"replay", file, "--serve", "--loop", "--port", "0"}, folder / "replay.log");
  const Outcome outcome = cat240({replay.await(" on "), "--to", receiver.to, "--frames", "4"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  int up = 0, down = 0;
  std::optional<Message> before;
  for (const Message& got : receiver.all()) {
    if (got.summary) continue;
    if (before && got.start_az == before->end_az) ++up;
    if (before && got.end_az == before->start_az) ++down;
    before = got;
  }
  EXPECT_GE(up, 7) << "a pass to the right";
  EXPECT_GE(down, 7) << "and one back";
}

TEST_F(Cat240Command, NewGeometryIsToldByANewSummary) {
  const std::string scene = folder.write("scene.toml", text_of(SmallScene{}));
  const Daemon daemon({"--config", scene}, folder.path());
  Running feed({"cat240", daemon.address(), "--to", receiver.to, "--rate", "20", "--summary-s", "3600"},
               folder / "feed.log");
  Message message = receiver.receive();
  EXPECT_TRUE(message.summary);
  while ((message = receiver.receive()).summary) FAIL() << "one is enough";
  const std::uint32_t cell_dur = message.cell_dur;
  client::Client client = connected(daemon.address());
  const std::string radar = client.welcome().radars(0);
  ASSERT_TRUE(client.claim_control(radar).ok());
  wire::RadarSettings settings;
  settings.set_r_max_m(16000);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings(radar, settings, ack).ok());
  while (!(message = receiver.receive()).summary) ASSERT_EQ(message.cell_dur, cell_dur);
  EXPECT_NEAR(receiver.receive().cell_dur, 2.0 * cell_dur, 1) << "twice the range, in femtoseconds";
  EXPECT_EQ(feed.end(SIGINT), 0) << feed.log();
}

TEST_F(Cat240Command, BadInputIsRefusedWithWhatIsAllowed) {
  const struct {
    std::vector<std::string> arguments;
    std::string says;
  } cases[] = {
      {{"127.0.0.1:1"}, "--to is required"},
      {{"127.0.0.1:1", "--to", "239.192.24.1"}, "--to: found \"239.192.24.1\"; allowed: HOST:PORT"},
      {{"127.0.0.1:1", "--to", "nowhere.invalid:8600"}, "--to: found \"nowhere.invalid:8600\" ("},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--interface", "eth0"},
       "--interface: found \"eth0\"; allowed: an IPv4"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--bits", "12"}, "--bits"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--sac", "256"}, "--sac"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--ttl", "0"}, "--ttl"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--max-datagram", "98"}, "--max-datagram"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--max-datagram", "65508"}, "--max-datagram"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600", "--summary-s", "nan"}, "--summary-s"},
      {{"127.0.0.1:1", "--to", "127.0.0.1:8600"}, "127.0.0.1:1"},  // nobody listens
  };
  for (const auto& [arguments, says] : cases) {
    const Outcome outcome = cat240(arguments);
    EXPECT_EQ(outcome.code, 1) << says;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << says << "\nin: " << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
}

TEST_F(Cat240Command, CellsThatAreTooLongAreRefusedByName) {
  std::string text = text_of(SmallScene{.range_bins = 8});
  const Daemon daemon({"--config", folder.write("scene.toml", text)}, folder.path());
  client::Client client = connected(daemon.address());
  const std::string radar = client.welcome().radars(0);
  EXPECT_TRUE(client.claim_control(radar).ok());
  wire::RadarSettings settings;
  settings.set_r_max_m(2000 + 8 * 644.0);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings(radar, settings, ack).ok());
  const Outcome outcome = cat240({daemon.address(), "--to", receiver.to, "--frames", "1"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("found range bins of 644.0 m (range_spacing_m); allowed: at most 643.8 m"),
            std::string::npos)
      << outcome.err;
  EXPECT_TRUE(receiver.all().empty());
  settings.set_r_max_m(2000 + 8 * 643.0);
  ASSERT_TRUE(client.set_settings(radar, settings, ack).ok());
  EXPECT_EQ(cat240({daemon.address(), "--to", receiver.to, "--frames", "1"}).code, 0);
}

TEST_F(Cat240Command, ARateThatTheServerRefusesIsRefusedBeforeAnythingIsSaidToBeSent) {
  const Daemon daemon({"--config", folder.write("scene.toml", text_of(SmallScene{}))}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  client::Client client = connected(daemon.address());
  const double most_hz = client.welcome().limits().max_rate_hz();
  for (const double rate_hz : {most_hz * 1.001, 9999.0}) {
    const Outcome outcome =
        cat240({daemon.address(), "--to", receiver.to, "--rate", std::to_string(rate_hz)});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.out, "") << "nothing is sent";
    EXPECT_NE(outcome.err.find("allowed: a number from 0.001 to 100 ("), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(most_hz, 100) << "what the server takes, and what the command says";
}

TEST_F(Cat240Command, OneFrameIsCountedInTheSingular) {
  const Daemon daemon({"--config", folder.write("scene.toml", text_of(SmallScene{}))}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome outcome = cat240({daemon.address(), "--to", receiver.to, "--frames", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find(": 1 frame, 36 radials, 37 datagrams sent, 0 could not be sent\n"),
            std::string::npos)
      << outcome.out;
}

TEST_F(Cat240Command, AReplayWithoutVideoIsRefusedWithThePlanesThatItHas) {
  const std::string scene = folder.write("scene.toml", text_of(SmallScene{}));
  const std::string file = folder / "state.obliq";
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(
        obliq({"record", "--server", daemon.address(), "--out", file, "--frames", "1", "--planes", "state"})
            .code,
        0);
  }
  Running replay({"replay", file, "--serve", "--loop", "--port", "0"}, folder / "replay.log");
  const Outcome outcome = cat240({replay.await(" on "), "--to", receiver.to});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out, "") << "nothing is sent";
  EXPECT_NE(outcome.err.find("video"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("allowed: state"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace obliq::test::cat240_test
