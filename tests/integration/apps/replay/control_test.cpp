// A served replay is paused, moved and sped up by its clients, for all of them.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <limits>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/record_fixture.h"
#include "tests/support/made_recording.h"

namespace obliq::test::control_test {
namespace {

constexpr double kStep_s = 0.1;
constexpr std::int64_t kStep_ns = 100'000'000;
constexpr int kFrames = 600;

/// What a station sees: frames by the number that they were recorded with.
class Station : public client::FrameAssembler {
 public:
  Station() : FrameAssembler(wire::plane_bit(wire::Plane::power)) {}

  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte> values) override {
    ++blocks_of_frame;
    return FrameAssembler::on_block(header, block, values);
  }
  client::Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override {
    blocks_of_frame = 0;
    sim_time_ns = begin.frame().pose().sim_time_ns();
    return FrameAssembler::on_begin(header, begin);
  }
  client::Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override {
    const client::Status status = FrameAssembler::on_end(header, end);
    if (state() == State::complete) seen.push_back(static_cast<int>(take().power_w.front() / 1e6));
    return status;
  }
  client::Status on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) override {
    reason = abort.reason();
    const client::Status status = FrameAssembler::on_abort(header, abort);
    (void)take();
    return status;
  }
  /// Without losses, so that what is expected comes however busy the machine is.
  void subscribe() {
    wire::Subscribe request;
    request.set_radar("main");
    request.set_rate_hz(100);
    request.add_planes(wire::POWER);
    request.set_lossless(true);
    ASSERT_TRUE(client.subscribe(request).ok());
  }
  const wire::ReplayState& state_of_replay() const { return *client.replay_state(); }
  /// Receives until that is so.
  template <typename Condition>
  ::testing::AssertionResult until(const Condition& condition) {
    while (!condition()) {
      const client::Status status = client.receive(kLong);
      if (!status.ok()) return ::testing::AssertionFailure() << status.text;
    }
    return ::testing::AssertionSuccess();
  }
  client::Status set(const std::function<void(wire::SetReplay&)>& fill) {
    wire::SetReplay request;
    fill(request);
    return client.set_replay(request);
  }
  client::Status pause(bool paused) {
    return set([&](wire::SetReplay& request) { request.set_paused(paused); });
  }
  client::Status seek(double to_s) {
    return set([&](wire::SetReplay& request) { request.set_seek_s(to_s); });
  }

  client::Client client;
  std::vector<int> seen;
  int blocks_of_frame = 0;
  std::int64_t sim_time_ns = 0;
  std::string reason;
};

class ReplayControl : public RecordTest {
 protected:
  std::string serve(std::vector<std::string> more = {}, int frames = kFrames) {
    const std::string path = folder.write("timed.obliq", timed_recording(frames, kStep_ns).bytes);
    std::vector<std::string> all = {"replay", path, "--serve", "--port", "0"};
    all.insert(all.end(), more.begin(), more.end());
    replay = std::make_unique<Running>(all, folder / "replay.log");
    return replay->await(" on ");
  }
  void connect(Station& station, const std::string& address) const {
    station.client.set_handler(&station);
    ASSERT_TRUE(station.client.connect(*client::parse_endpoint(address)).ok()) << replay->log();
    ASSERT_TRUE(station.until([&] { return station.client.replay_state() != nullptr; }));
  }
  std::unique_ptr<Running> replay;
};

TEST_F(ReplayControl, EachClientIsToldWhereTheReplayIs) {
  Station station;
  connect(station, serve());
  const wire::ReplayState& state = station.state_of_replay();
  EXPECT_EQ(state.radar(), "main");
  EXPECT_EQ(state.start_utc_ns(), kMadeStart_ns);
  EXPECT_NEAR(state.duration_s(), (kFrames - 0.01) * kStep_s, 1e-6);
  EXPECT_EQ(state.position_s(), 0);
  EXPECT_EQ(state.speed(), 1);
  EXPECT_FALSE(state.paused());
  EXPECT_FALSE(state.running()) << "nobody watches";
  station.subscribe();
  ASSERT_TRUE(station.until([&] { return station.state_of_replay().running(); }));
}

TEST_F(ReplayControl, ASeekInAPauseShowsTheFrameBeforeAndTheFrameOfThePlaceToAllStations) {
  Station one, two;
  const std::string address = serve();
  connect(one, address);
  connect(two, address);
  ASSERT_TRUE(one.pause(true).ok());
  one.subscribe();
  two.subscribe();
  for (const auto& [to_s, frame] : {std::pair{40.05, 401}, {3.05, 31}, {59.95, 600}, {0.05, 1}}) {
    ASSERT_TRUE(one.seek(to_s).ok());
    for (Station* station : {&one, &two}) {
      // Half of the frame of the place has been sent by then: one of its two wedges.
      ASSERT_TRUE(station->until([&, place_s = to_s, number = frame] {
        return station->sim_time_ns == kMadeSimStart_ns + (number - 1) * kStep_ns &&
               station->blocks_of_frame == 1 &&
               std::abs(station->state_of_replay().position_s() - place_s) < 1e-6;
      }));
      if (frame > 1) {
        EXPECT_EQ(station->seen.back(), frame - 1);
      }
      EXPECT_TRUE(station->state_of_replay().paused());
    }
  }
  EXPECT_EQ(two.state_of_replay().seeks(), 4u);
  EXPECT_EQ(two.reason, "the replay went to another place");
  two.seen.clear();
  ASSERT_TRUE(two.pause(false).ok());
  ASSERT_TRUE(one.until([&] { return !one.state_of_replay().paused(); }));
  ASSERT_TRUE(two.until([&] { return two.seen.size() > 2; }));
  EXPECT_EQ(two.seen.front(), 1) << "it goes on in the middle of the frame";
  EXPECT_TRUE(std::ranges::is_sorted(two.seen));
}

TEST_F(ReplayControl, AStationThatJoinsInAPauseSeesWhatTheOthersSee) {
  Station one, two;
  const std::string address = serve();
  connect(one, address);
  one.subscribe();
  ASSERT_TRUE(one.pause(true).ok());
  ASSERT_TRUE(one.seek(20.05).ok());
  ASSERT_TRUE(one.until([&] { return !one.seen.empty() && one.seen.back() == 200; }));
  connect(two, address);
  EXPECT_TRUE(two.state_of_replay().paused());
  EXPECT_NEAR(two.state_of_replay().position_s(), 20.05, 1e-6);
  two.subscribe();
  ASSERT_TRUE(two.until([&] { return !two.seen.empty() && two.blocks_of_frame == 1; }));
  EXPECT_EQ(two.seen, std::vector<int>{200});
  EXPECT_EQ(two.sim_time_ns, kMadeSimStart_ns + 200 * kStep_ns);
}

TEST_F(ReplayControl, APlaceIsFoundByThePosesClock) {
  Station station;
  connect(station, serve());
  ASSERT_TRUE(station.pause(true).ok());
  station.subscribe();
  const auto seek = [&](std::int64_t sim_time_ns) {
    return station.set([&](wire::SetReplay& request) { request.set_seek_sim_time_ns(sim_time_ns); });
  };
  ASSERT_TRUE(seek(kMadeSimStart_ns + 30 * kStep_ns + 5).ok());
  ASSERT_TRUE(station.until([&] { return station.sim_time_ns == kMadeSimStart_ns + 30 * kStep_ns; }));
  ASSERT_TRUE(station.until([&] { return std::abs(station.state_of_replay().position_s() - 3.0) < 1e-6; }));
}

TEST_F(ReplayControl, AtAHundredfoldSpeedAMinuteTakesAboutASecondAndFramesAreLeftOut) {
  Station station;
  connect(station, serve({"--hold"}));
  ASSERT_TRUE(station.set([](wire::SetReplay& request) { request.set_speed(100); }).ok());
  station.subscribe();
  ASSERT_TRUE(station.until([&] { return station.client.replay_state()->ended(); }));
  EXPECT_EQ(station.state_of_replay().speed(), 100);
  EXPECT_LT(station.seen.size(), static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(std::ranges::is_sorted(station.seen));
}

TEST_F(ReplayControl, AtTheEndItHoldsAndASeekGoesBack) {
  Station station;
  connect(station, serve({"--hold", "--speed", "max"}, 20));
  station.subscribe();
  ASSERT_TRUE(station.until([&] { return station.client.replay_state()->ended(); }));
  EXPECT_NEAR(station.state_of_replay().position_s(), station.state_of_replay().duration_s(), 1e-9);
  EXPECT_FALSE(station.state_of_replay().running());
  // Frames of a slow client are left out, the newest is not.
  ASSERT_TRUE(station.until([&] { return !station.seen.empty() && station.seen.back() == 20; }));
  ASSERT_TRUE(station.pause(true).ok());
  ASSERT_TRUE(station.seek(0.55).ok());
  ASSERT_TRUE(station.until([&] { return station.sim_time_ns == kMadeSimStart_ns + 5 * kStep_ns; }));
  EXPECT_EQ(station.seen.back(), 5);
  EXPECT_FALSE(station.state_of_replay().ended());
  EXPECT_EQ(replay->end(SIGTERM), 0) << replay->log();
}

TEST_F(ReplayControl, BadWishesAreRefusedWithWhatIsAllowedAndChangeNothing) {
  Station station;
  connect(station, serve());
  const struct {
    std::function<void(wire::SetReplay&)> fill;
    std::string field, allowed;
  } cases[] = {
      {[](wire::SetReplay& r) { r.set_speed(0); }, "speed",
       "0.01 to 1000000 recorded seconds in a second, or infinity (without waiting)"},
      {[](wire::SetReplay& r) { r.set_speed(-1); }, "speed", "0.01 to"},
      {[](wire::SetReplay& r) { r.set_speed(std::nan("")); }, "speed", "0.01 to"},
      {[](wire::SetReplay& r) { r.set_seek_s(-0.1); }, "seek_s", "0 to 59.999 s, its length"},
      {[](wire::SetReplay& r) { r.set_seek_s(61); }, "seek_s", "0 to 59.999 s"},
      {[](wire::SetReplay& r) { r.set_seek_s(std::numeric_limits<double>::infinity()); }, "seek_s", "0 to"},
      {[](wire::SetReplay& r) { r.set_paused(true), r.set_seek_s(1), r.set_seek_sim_time_ns(1); },
       "seek_sim_time_ns", "one of the two"},
  };
  for (const auto& [fill, field, allowed] : cases) {
    const client::Status refused = station.set(fill);
    EXPECT_EQ(refused.number, static_cast<std::uint32_t>(wire::ErrorNumber::invalid_value));
    ASSERT_EQ(refused.fields.size(), 1u) << refused.text;
    EXPECT_EQ(refused.fields[0].field, field);
    EXPECT_NE(refused.fields[0].allowed.find(allowed), std::string::npos) << refused.fields[0].allowed;
  }
  EXPECT_FALSE(station.state_of_replay().paused());
  EXPECT_EQ(station.state_of_replay().seeks(), 0u);
}

TEST_F(ReplayControl, PosesWithoutAClockAreNoPlace) {
  const std::string path = folder.write("made.obliq", made_recording().bytes);
  replay = std::make_unique<Running>(std::vector<std::string>{"replay", path, "--serve", "--port", "0"},
                                     folder / "replay.log");
  Station station;
  connect(station, replay->await(" on "));
  const client::Status refused =
      station.set([](wire::SetReplay& request) { request.set_seek_sim_time_ns(5'000'000'000); });
  ASSERT_EQ(refused.fields.size(), 1u) << refused.text;
  EXPECT_NE(refused.fields[0].allowed.find("the poses of this recording have no sim_time_ns"),
            std::string::npos);
}

TEST_F(ReplayControl, ALiveServerSaysThatItIsNoReplay) {
  const Daemon daemon({"--config", scene}, folder.path());
  client::Client client = connected(daemon.address());
  wire::SetReplay request;
  request.set_paused(true);
  const client::Status refused = client.set_replay(request);
  EXPECT_EQ(refused.number, static_cast<std::uint32_t>(wire::ErrorNumber::not_a_replay));
  EXPECT_NE(refused.text.find("this server's radars are live"), std::string::npos) << refused.text;
  EXPECT_EQ(client.replay_state(), nullptr);
}

}  // namespace
}  // namespace obliq::test::control_test
