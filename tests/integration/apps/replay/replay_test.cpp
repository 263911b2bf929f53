// obliq replay: files and a server out of a recording.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <limits>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "server/stream/frame_encoder.h"
#include "tests/integration/clients.h"
#include "tests/integration/record_fixture.h"
#include "tests/support/made_recording.h"

namespace obliq::test::replay_test {
namespace {

TEST_F(RecordTest, TimesThatLieFurtherApartThanANumberHoldsAreShownAsTheyAre) {
  MadeRecording made = made_recording();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  std::size_t begin = 0;
  while (made.messages[begin].type != wire::MessageType::frame_begin) ++begin;
  set_time(made, begin, kLeast);
  std::size_t end = begin;
  while (made.messages[end].type != wire::MessageType::frame_end) ++end;
  set_time(made, end, std::numeric_limits<std::int64_t>::max());
  const Outcome outcome = obliq({"replay", folder.write("lying.obliq", made.bytes), "--speed", "max"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  // 2^64 ns.
  EXPECT_NE(outcome.out.find("frame 1: 18446744073.710 s into the recording"), std::string::npos)
      << outcome.out;
}

TEST_F(RecordTest, ReplayWritesTheFilesOfTheRadarThatWasRecordedBitForBit) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome recorded = obliq(record(daemon.address(), {"--out", file, "--frames", "3"}));
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  EXPECT_NE(recorded.out.find("radar main, 3 frames"), std::string::npos) << recorded.out;

  const Outcome replayed = obliq({"replay", file, "--speed", "max", "--out", folder / "replayed"});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_EQ(replayed.err, "");
  EXPECT_NE(replayed.out.find("3 frames, "), std::string::npos) << replayed.out;
  EXPECT_NE(replayed.out.find(std::to_string(std::filesystem::file_size(file)) + " bytes, nothing left over"),
            std::string::npos)
      << replayed.out;
  ASSERT_EQ(obliq({"render", scene, "--radar", "main", "--out", folder / "rendered"}).code, 0);
  for (const char* name :
       {"bins.npy", "power.npy", "count.npy", "state.npy", "ground_map.png", "ground_map.tif"}) {
    EXPECT_TRUE(text_of(folder / "rendered" / name) == text_of(folder / "replayed" / name)) << name;
  }
}

TEST_F(RecordTest, ReplayServesTheFramesToAClientBitForBitAndRefusesWhatOnlyARadarCan) {
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "4"})).code, 0);
  }
  auto expected = frames_of(file);
  ASSERT_EQ(expected.size(), 4u);

  Running replay({"replay", file, "--serve", "--port", "0"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  ASSERT_NE(address, "") << replay.log();
  client::Client client = connected(address);
  ASSERT_EQ(client.welcome().radars_size(), 1);
  EXPECT_EQ(client.welcome().radars(0), "main");
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().azimuth_bins(), 36);
  EXPECT_EQ(info.pose().bearing_deg(), 20);

  const auto only = static_cast<std::uint32_t>(wire::ErrorNumber::replay_only);
  wire::Ack ack;
  wire::RenderOnce once;
  once.mutable_pose()->set_latitude_deg(33);
  EXPECT_EQ(client.claim_control("main").number, only);
  EXPECT_EQ(client.set_settings("main", {}, ack).number, only);
  EXPECT_EQ(client.set_pose("main", {}, ack).number, only);
  EXPECT_EQ(client.set_state("main", false, {}).number, only);
  const client::Status refused = client.render_once(once);
  EXPECT_EQ(refused.number, only);
  EXPECT_NE(refused.text.find("replays a recording"), std::string::npos) << refused.text;

  client::FrameAssembler frames;
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 100).ok());
  std::size_t seen = 0;
  client::Status status;
  while ((status = client.receive(kLong)).ok()) {
    if (frames.state() == client::FrameAssembler::State::aborted) (void)frames.take();
    if (frames.state() != client::FrameAssembler::State::complete) continue;
    const client::AssembledFrame got = frames.take();
    ++seen;
    // A machine that is busy may leave frames out, as with a radar; those that come are the recorded ones.
    const auto at = std::find_if(expected.begin(), expected.end(), [&](const auto& one) {
      return one.second.power_w == got.power_w && one.second.iq == got.iq;
    });
    ASSERT_NE(at, expected.end());
    EXPECT_EQ(got.count, at->second.count);
    EXPECT_EQ(got.state, at->second.state);
    EXPECT_EQ(got.descriptor->pose().SerializeAsString(), at->second.descriptor->pose().SerializeAsString());
  }
  EXPECT_GE(seen, 1u);
  // The recording's end is the server's.
  EXPECT_EQ(status.number, static_cast<std::uint32_t>(wire::ErrorNumber::server_stopping)) << status.text;
  EXPECT_EQ(replay.wait(), 0) << replay.log();
}

TEST_F(RecordTest, AServedReplayHasTheServersLimitOfMemory) {
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1"})).code, 0);
  }
  const Outcome refused = obliq({"replay", file, "--serve", "--port", "0", "--max-memory-mb", "1"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("max_memory_mb is 1: the frame needs about 1 MB beside "), std::string::npos)
      << refused.err;
  EXPECT_NE(refused.err.find("--max-memory-mb"), std::string::npos) << refused.err;
  for (const auto& [limit, expected] : {std::pair("5000", 5000u), std::pair("inf", 0u)}) {
    Running replay({"replay", file, "--serve", "--port", "0", "--max-memory-mb", limit},
                   folder / ("replay" + std::string(limit) + ".log"));
    client::Client client = connected(replay.await(" on "));
    EXPECT_EQ(client.welcome().limits().max_memory_mb(), expected);
  }
}

/// Keeps what is said of passes and of their dwells.
class Passes : public client::FrameAssembler {
 public:
  using FrameAssembler::FrameAssembler;
  client::Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override {
    scan = begin.scan();
    scans = scans || begin.has_scan();
    beams_ns.clear();
    azimuths.clear();
    begun_ns = header.utc_ns;
    return FrameAssembler::on_begin(header, begin);
  }
  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte> values) override {
    if (beams_ns.empty() || beams_ns.back() != block.beam_ns()) beams_ns.push_back(block.beam_ns());
    if (azimuths.empty() || azimuths.back() != block.first_azimuth())
      azimuths.push_back(block.first_azimuth());
    // The beam was there before the block was sent.
    EXPECT_LE(block.beam_ns(), block.send_ns());
    EXPECT_GT(block.beam_ns(), scan.begin_ns());
    return FrameAssembler::on_block(header, block, values);
  }
  bool scans = false;
  wire::ScanPass scan;
  std::vector<std::int64_t> beams_ns;   ///< of the pass, one for each dwell
  std::vector<std::uint32_t> azimuths;  ///< in the order in which they came
  std::int64_t begun_ns = 0;
};

TEST_F(RecordTest, ThePassesOfAScanningAntennaAreServedBitForBitWithTheirScanAndBeam) {
  folder.write("scene.toml", text_of(SmallScene{.server = "[scan]\nmode = \"sector\"\nrate_deg_s = 240.0\n"
                                                          "dwell_bins = 8\n"}));
  {
    const Daemon daemon({"--config", scene}, folder.path());
    const Outcome recorded = obliq(record(daemon.address(), {"--out", file, "--frames", "3"}));
    ASSERT_EQ(recorded.code, 0) << recorded.err;
  }
  const auto expected = frames_of(file);
  ASSERT_EQ(expected.size(), 3u);
  Running replay({"replay", file, "--serve", "--port", "0"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  client::Client client = connected(address);
  Passes passes;
  client.set_handler(&passes);
  ASSERT_TRUE(client.subscribe("main", 100).ok());
  std::size_t seen = 0;
  while (client.receive(kLong).ok()) {
    if (passes.state() == client::FrameAssembler::State::aborted) (void)passes.take();
    if (passes.state() != client::FrameAssembler::State::complete) continue;
    const client::AssembledFrame got = passes.take();
    ++seen;
    EXPECT_EQ(passes.scan.mode(), wire::SECTOR_SCAN);
    EXPECT_EQ(passes.scan.rate_deg_s(), 240);
    EXPECT_EQ(passes.scan.dwell_bins(), 8u);
    EXPECT_TRUE(passes.scan.clockwise() ? std::ranges::is_sorted(passes.azimuths)
                                        : std::ranges::is_sorted(passes.azimuths, std::greater<>()));
    // A dwell of 8 bins of 60/36 degrees lasts 55.6 ms; replayed, each time is as old as when it was
    // recorded, but for the time between two threads.
    if (passes.beams_ns.size() > 1) {
      const double pass_s = 1e-9 * static_cast<double>(passes.beams_ns.back() - passes.beams_ns.front());
      EXPECT_GT(pass_s, 0);
    }
    // The poses are the same, and so are the values, but for what a busy machine may have missed.
    EXPECT_TRUE(std::any_of(expected.begin(), expected.end(), [&](const auto& one) {
      return one.second.power_w == got.power_w && one.second.state == got.state;
    }));
  }
  EXPECT_GE(seen, 1u);
  EXPECT_TRUE(passes.scans);
  EXPECT_EQ(replay.wait(), 0) << replay.log();
}

TEST_F(RecordTest, ARecordingOfAPartOfTheBinsIsReplayedToFiles) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--azimuths", "8:24"})).code, 0);
  const Outcome replayed = obliq({"replay", file, "--speed", "max", "--out", folder / "part"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_NE(replayed.out.find(", nothing left over"), std::string::npos) << replayed.out << replayed.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "part" / "power.npy"));
}

TEST_F(RecordTest, ARecordingOfSomePlanesIsReplayedToTheirFilesWithAWordAboutTheOthers) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::map<std::string, std::string> name_of = {
      {"iq", "bins.npy"}, {"power", "power.npy"}, {"count", "count.npy"}, {"state", "state.npy"}};
  for (const std::string planes :
       {"iq", "power", "count", "state", "iq,count", "iq,state", "power,state", "iq,count,state"}) {
    ASSERT_EQ(
        obliq(record(daemon.address(), {"--out", file, "--force", "--frames", "1", "--planes", planes})).code,
        0);
    for (const auto& command :
         {std::vector<std::string>{"replay", file, "--speed", "max"},
          {"get", "--server", daemon.address(), "--radar", "main", "--planes", planes},
          {"watch", "--server", daemon.address(), "--radar", "main", "--planes", planes, "--frames", "1"}}) {
      std::filesystem::remove_all(folder / "files");
      auto arguments = command;
      arguments.insert(arguments.end(), {"--out", folder / "files"});
      const Outcome outcome = obliq(arguments);
      EXPECT_EQ(outcome.code, 0) << command[0] << " " << planes << ": " << outcome.err;
      EXPECT_NE(outcome.err.find("the frame came without "), std::string::npos) << outcome.err;
      for (const auto& [plane, name] : name_of) {
        const bool wanted = ("," + planes + ",").find("," + plane + ",") != std::string::npos;
        EXPECT_EQ(std::filesystem::exists(folder / "files" / name), wanted)
            << command[0] << " " << planes << " " << name;
      }
      const bool drawn = planes.find("iq") != std::string::npos || planes.find("power") != std::string::npos;
      EXPECT_EQ(std::filesystem::exists(folder / "files" / "ground_map.png"), drawn)
          << command[0] << " " << planes;
    }
  }
}

/// A frame of which a scanning antenna missed everything: no block, and a FrameEnd that says so.
void add_missed_frame(MadeRecording& recording, std::uint64_t frame_id, std::uint64_t& sequence) {
  stream::FrameEncoder encoder({.stream_id = 1, .frame_id = frame_id}, sequence);
  wire::FrameDescriptor descriptor;
  descriptor.set_radar("main");
  descriptor.set_frame_id(frame_id);
  descriptor.mutable_settings()->set_azimuth_bins(kMadeAzimuths);
  descriptor.mutable_settings()->set_range_bins(kMadeRanges);
  for (const auto& block : encoder.begin(descriptor)) recording.add(block->bytes, block->type, frame_id);
  wire::FrameSummary summary;
  summary.set_frame_id(frame_id);
  const auto end = encoder.end(summary, 0.001, {{0, kMadeAzimuths}});
  recording.add(end->bytes, end->type, frame_id);
}

TEST_F(RecordTest, AFrameThatEndsWithoutABlockIsReplayedToFilesAndHidesNoFrameBehindIt) {
  MadeRecording recording;
  std::uint64_t sequence = 0;
  add_missed_frame(recording, 1, sequence);
  const Outcome alone = obliq(
      {"replay", folder.write("none.obliq", recording.bytes), "--speed", "max", "--out", folder / "none"});
  EXPECT_EQ(alone.code, 0) << alone.err;
  EXPECT_NE(alone.err.find("none of its frames has values"), std::string::npos) << alone.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "none" / "frame.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "none" / "bins.npy"));

  add_frame(recording, 2, sequence);
  client::RecordingStart start;
  std::unique_ptr<client::RecordingReader> reader;
  ASSERT_TRUE(client::RecordingReader::open(folder.write("both.obliq", recording.bytes), reader).ok());
  ASSERT_TRUE(client::read_start(*reader, "", start).ok());
  EXPECT_EQ(start.planes, wire::kAllPlanes);
  EXPECT_EQ(start.descriptor->frame_id(), 1u);
}

TEST_F(RecordTest, PlanesThatWereNotRecordedAreNotServed) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--planes", "iq,state"})).code,
            0);
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  client::Client client = connected(address);
  const client::Status refused = client.subscribe("main", 10);
  ASSERT_EQ(refused.fields.size(), 1u) << refused.text;
  EXPECT_EQ(refused.fields[0].allowed, "iq, state, video");
  const auto planes =
      static_cast<wire::PlaneSet>(wire::plane_bit(wire::Plane::iq) | wire::plane_bit(wire::Plane::state));
  client::FrameAssembler frames(planes);
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 10, planes).ok());
  while (frames.state() != client::FrameAssembler::State::complete) ASSERT_TRUE(client.receive(kLong).ok());
  EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
}

/// A recording of `frames` frames, made without a server.
std::string made(int frames) {
  MadeRecording recording;
  std::uint64_t sequence = 0;
  for (int id = 1; id <= frames; ++id) {
    add_frame(recording, static_cast<std::uint64_t>(id), sequence);
  }
  return recording.bytes;
}

/// Two frames in whole messages, but the FrameEnd of the first is not there.
std::string made_with_a_gap() {
  MadeRecording recording;
  std::uint64_t sequence = 0;
  add_frame(recording, 1, sequence);
  recording.bytes.resize(recording.messages.back().begin);
  add_frame(recording, 2, sequence);
  return recording.bytes;
}

TEST_F(RecordTest, FramesThatAreLostAreCountedAndReplayedAroundWithAnExitCodeOfTheirOwn) {
  const std::string gapped = folder.write("gap.obliq", made_with_a_gap());
  Outcome outcome = obliq({"replay", gapped, "--speed", "max"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("frame 1 is incomplete"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("obliq: " + gapped + ": 1 frame lost; what is whole has been replayed\n"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.out.find(" bytes, 1 frame lost\n"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("nothing left over"), std::string::npos) << outcome.out;

  const std::string cut = folder.write("cut.obliq", made(2).substr(0, made(2).size() - 1));
  outcome = obliq({"replay", cut, "--speed", "max"});
  EXPECT_EQ(outcome.code, 0) << "a recorder that was killed loses its last frame and no other";
  EXPECT_NE(outcome.out.find("1 frame, "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(", the end is cut\n"), std::string::npos) << outcome.out;

  const Outcome help = obliq({"replay", "--help"});
  EXPECT_NE(help.out.find("Exit code: 0 all frames replayed"), std::string::npos) << help.out;
}

TEST_F(RecordTest, AFrustumThatMakesNoFramesAnyMoreIsReplayedPrintedAndServed) {
  const std::string old = folder.write("old.obliq", made(2));
  const std::string polar = "\"frustum\": \"polar\"";
  Outcome outcome = obliq({"replay", old, "--speed", "max", "--out", folder / "files"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(text_of(folder / "files" / "frame.json").find(polar), std::string::npos);
  Running replay({"replay", old, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  ASSERT_NE(address, "") << replay.log();
  outcome = obliq({"watch", "--server", address, "--frames", "1", "--rate", "20", "--out", folder / "seen"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(text_of(folder / "seen" / "frame.json").find(polar), std::string::npos);
  outcome = obliq({"set", "--server", address, "--radar", "main"});
  EXPECT_NE(outcome.out.find("frustum.kind = \"polar\""), std::string::npos) << outcome.out << outcome.err;
}

TEST_F(RecordTest, AServedRecordingThatLostFramesEndsWithThatExitCodeToo) {
  Running replay({"replay", folder.write("gap.obliq", made_with_a_gap()), "--serve", "--port", "0"},
                 folder / "replay.log");
  client::Client client;
  const std::string address = replay.await(" on ");
  ASSERT_NE(address, "") << replay.log();
  ASSERT_TRUE(client.connect(*client::parse_endpoint(address)).ok());
  ASSERT_TRUE(client.subscribe("main", 100).ok());
  while (client.receive(kLong).ok()) {
  }
  EXPECT_EQ(replay.wait(), 2) << replay.log();
  EXPECT_NE(replay.log().find("1 frame lost"), std::string::npos) << replay.log();
}

TEST_F(RecordTest, WhatIsNoRecordingIsNamed) {
  const std::string empty = folder.write("empty.obliq", "");
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string allowed = "; allowed: a file that `obliq record` wrote\n";
  for (const auto& [path, said] : std::vector<std::pair<std::string, std::string>>{
           {empty, ": it is empty, so no frame begins in it"},
           {folder.path(), ": found a folder" + allowed},
           {pipe, ": found a pipe" + allowed},
           {"/dev/full", ": found a device" + allowed},
           {"/dev/null", ": found a device" + allowed},
           {folder / "none.obliq", ": cannot be read: No such file or directory\n"}}) {
    const Outcome outcome = obliq({"replay", path});
    EXPECT_EQ(outcome.code, 1) << path;
    EXPECT_EQ(outcome.err.find("obliq: " + path + said), 0u) << outcome.err;
    EXPECT_EQ(outcome.out, "") << path;
  }
  if (geteuid() == 0) return;  // who may read everything
  std::filesystem::permissions(empty, std::filesystem::perms::none);
  EXPECT_EQ(obliq({"replay", empty}).err, "obliq: " + empty + ": cannot be read: Permission denied\n");
}

}  // namespace
}  // namespace obliq::test::replay_test
