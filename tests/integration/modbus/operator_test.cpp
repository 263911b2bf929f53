// What the operator's console does to a radar that clients of the stream watch and control.
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <optional>

#include "proto/obliq.pb.h"
#include "tests/integration/modbus/modbus_fixture.h"
#include "tests/support/loopback.h"

namespace obliq::test::operator_test {
namespace {

constexpr std::uint16_t kTransmitOff = 2;
constexpr std::uint16_t kFrozen = 3;
constexpr std::uint16_t kFault = 4;

/// A client that watches "main".
struct WatchedServer : ModbusServer {
  using ModbusServer::ModbusServer;

  void watch() { ASSERT_TRUE(is_ok(client.subscribe("main", 50))); }
  const client::AssembledFrame& next_frame() {
    frames = std::make_unique<client::FrameAssembler>();
    EXPECT_TRUE(is_ok(receive_frame(client, *frames)));
    return frames->frame();
  }
  wire::RadarInfo info() {
    wire::RadarInfo info;
    client::Client asker = connect(server, "asker");
    EXPECT_TRUE(asker.get_radar("main", info).ok());
    return info;
  }

  client::Client client = connect(server);
  std::unique_ptr<client::FrameAssembler> frames;
};

class ModbusOperator : public testing::Test {
 protected:
  WatchedServer s;
  RawMaster master{s.service.port()};
};

TEST_F(ModbusOperator, WithTransmitOffNothingIsRenderedAndWatchersStay) {
  s.watch();
  s.next_frame();
  EXPECT_EQ(master.coil(0, false), 0);
  EXPECT_EQ(master.input(100), kTransmitOff);
  EXPECT_FALSE(master.coil_is(0));
  EXPECT_TRUE(s.info().transmit_off());
  EXPECT_EQ(s.info().subscribers(), 1u);
  // The current frame may still be counted; after the next snapshots no other is.
  const std::uint16_t beat = master.input(5);
  EXPECT_TRUE(master.reaches(5, static_cast<std::uint16_t>(beat + 2)));
  const std::uint64_t frames = s.server.panel().status(0)->frames;
  const std::uint16_t later = master.input(5);
  EXPECT_TRUE(master.reaches(5, static_cast<std::uint16_t>(later + 2)));
  EXPECT_EQ(s.server.panel().status(0)->frames, frames);
  EXPECT_EQ(master.coil(0, true), 0);
  s.info();  // what waited is read
  EXPECT_TRUE(master.reaches(100, 1));
  EXPECT_FALSE(s.info().transmit_off());
}

TEST_F(ModbusOperator, AFrozenRadarKeepsItsPictureUntilTheThaw) {
  EXPECT_EQ(master.coil(1, true), 0);
  EXPECT_EQ(master.input(100), kFrozen);
  EXPECT_TRUE(s.info().frozen());
  ASSERT_TRUE(s.client.claim_control("main").ok());
  wire::Pose pose;
  pose.set_bearing_deg(90);
  wire::Ack ack;
  ASSERT_TRUE(s.client.set_pose("main", pose, ack).ok());
  s.watch();
  for (int i = 0; i < 3; ++i) {
    const client::AssembledFrame& frame = s.next_frame();
    EXPECT_EQ(frame.descriptor->pose().bearing_deg(), 45);
    expect_pattern(frame);
  }
  EXPECT_EQ(s.info().pose().bearing_deg(), 90);
  EXPECT_EQ(master.coil(1, false), 0);
  while (s.next_frame().descriptor->pose().bearing_deg() != 90) {
  }
}

TEST_F(ModbusOperator, AControllerAndTheConsoleSwitchTheSameRadar) {
  ASSERT_TRUE(s.client.claim_control("main").ok());
  ASSERT_TRUE(s.client.set_state("main", false, {}).ok());
  EXPECT_TRUE(master.reaches(100, kTransmitOff));
  EXPECT_FALSE(master.coil_is(0));
  EXPECT_FALSE(s.info().frozen()) << "what a request leaves out stays as it is";
  ASSERT_TRUE(s.client.set_state("main", {}, true).ok());
  EXPECT_TRUE(s.info().transmit_off());
  ASSERT_TRUE(s.client.set_state("main", true, {}).ok());
  EXPECT_TRUE(master.reaches(100, kFrozen));
  // Frames keep the pose of the freeze, and what is set meanwhile shows from the thaw on.
  wire::Pose pose;
  pose.set_bearing_deg(90);
  wire::Ack ack;
  ASSERT_TRUE(s.client.set_pose("main", pose, ack).ok());
  s.watch();
  EXPECT_EQ(s.next_frame().descriptor->pose().bearing_deg(), 45);
  // The newest switch counts, from any client; and a radar that is released stays as it is.
  EXPECT_EQ(master.coil(1, false), 0);
  EXPECT_FALSE(s.info().frozen());
  while (s.next_frame().descriptor->pose().bearing_deg() != 90) {
  }
  ASSERT_TRUE(s.client.set_state("main", {}, true).ok());
  ASSERT_TRUE(s.client.release_control("main").ok());
  EXPECT_TRUE(s.info().frozen());
  wire::Status status = status_of(s.client);
  EXPECT_TRUE(status.radars(0).frozen());
  EXPECT_FALSE(status.radars(1).frozen());
}

TEST_F(ModbusOperator, WhileAClientHoldsControlApplyIsBusyAndTheOperatorsCoilsWork) {
  ASSERT_TRUE(s.client.claim_control("main").ok());
  EXPECT_EQ(master.write(254, {18}), 0);
  EXPECT_EQ(master.coil(2, true), 6);
  EXPECT_EQ(master.input(113), 3);
  EXPECT_TRUE(master.discrete(6));
  EXPECT_EQ(s.info().settings().azimuth_bins(), 20);
  EXPECT_EQ(master.coil(0, false), 0);
  EXPECT_EQ(master.coil(1, true), 0);
  // Together with an apply that is refused, a coil is not done either.
  EXPECT_EQ(exception_of(master.ask({15, 0, 0, 0, 3, 1, 0b101})), 6);
  EXPECT_TRUE(s.info().transmit_off());
  ASSERT_TRUE(s.client.release_control("main").ok());
  EXPECT_EQ(exception_of(master.ask({15, 0, 0, 0, 3, 1, 0b101})), 0);
  EXPECT_FALSE(s.info().transmit_off());
  EXPECT_EQ(s.info().settings().azimuth_bins(), 18);
}

TEST_F(ModbusOperator, PlanesPerBinFollowTheBinsUnlessColumnsAreStagedToo) {
  EXPECT_EQ(master.write(250, {3}), 0);  // sweep
  EXPECT_EQ(master.write(320, {3}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.info().settings().pixel_columns(), 60);
  EXPECT_EQ(master.write(254, {40}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.info().settings().pixel_columns(), 120);
  EXPECT_EQ(master.write(252, {50}), 0);
  EXPECT_EQ(master.write(320, {4}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.info().settings().pixel_columns(), 50);
  EXPECT_EQ(s.info().settings().planes_per_bin(), 0);
}

TEST_F(ModbusOperator, TheRatesLimitHoldsForAllWatchers) {
  EXPECT_EQ(master.write(230, {250}), 0);  // 2.5 Hz
  EXPECT_EQ(master.coil(2, true), 0);
  s.watch();
  EXPECT_EQ(s.info().rate_hz(), 2.5);
  EXPECT_EQ(s.info().rate_limit_hz(), 2.5);
  EXPECT_EQ(master.write(230, {10001}), 3);
  EXPECT_EQ(master.input(114), 230);
  EXPECT_EQ(master.write(230, {0}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.info().rate_hz(), 50);
}

TEST_F(ModbusOperator, ARadarThatCannotBeRenderedIsInFaultUntilItIsMended) {
  EXPECT_EQ(master.write(204, {0, 5000}), 0);  // 5 m, too low for the stand-in's oblique frustum
  EXPECT_EQ(master.coil(2, true), 0);
  s.watch();
  EXPECT_TRUE(master.reaches(100, kFault));
  EXPECT_EQ(master.input(113), 5);
  EXPECT_TRUE(master.discrete(1));
  EXPECT_FALSE(master.discrete(0));
  EXPECT_EQ(master.write(250, {3}), 0);  // the sweep
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_TRUE(master.reaches(100, 1));
  EXPECT_TRUE(master.discrete(0));
  EXPECT_EQ(master.input(113), 0);
}

TEST_F(ModbusOperator, AFrustumThatCannotLookIsRefusedByApply) {
  EXPECT_EQ(master.write(250, {2}), 3) << "polar, which only recordings have";
  EXPECT_EQ(master.input(114), 250);
  EXPECT_EQ(master.write(242, {1, 0x2CC8}), 0);  // kGainOverPlates_db in mdB: 77000
  EXPECT_EQ(master.write(250, {3}), 0);
  EXPECT_EQ(master.coil(2, true), 3) << "a sweep over flat plates";
  EXPECT_EQ(master.input(113), 2);
  EXPECT_EQ(master.input(114), 250);
  EXPECT_EQ(master.write(242, {0, 0}), 0);
  EXPECT_EQ(master.write(245, {1}), 0);
  EXPECT_EQ(master.coil(2, true), 3) << "the paper's speckle of a sweep";
  EXPECT_EQ(master.input(114), 245);
  EXPECT_EQ(master.write(250, {1}), 0);  // with rays
  EXPECT_EQ(master.coil(2, true), 0);
}

TEST(ModbusMaster, AConsoleThatDiesHasItsRadarFrozenUntilSomebodyUndoesIt) {
  ModbusConfig config = modbus_on_any_port();
  config.watchdog_s = 0.2;
  WatchedServer s(config);
  RawMaster watching(s.service.port());
  const std::uint16_t beat = watching.input(5);
  EXPECT_TRUE(watching.reaches(5, static_cast<std::uint16_t>(beat + 5)));
  EXPECT_EQ(watching.input(100), 0);  // no console has beaten yet: no watchdog
  {
    RawMaster console(s.service.port());
    EXPECT_EQ(console.write(300, {1}), 0);
  }
  EXPECT_TRUE(watching.reaches(100, kFault));
  EXPECT_EQ(watching.input(113), 6);
  EXPECT_TRUE(watching.discrete(5));
  EXPECT_TRUE(watching.reaches(5, static_cast<std::uint16_t>(watching.input(5) + 2)));
  EXPECT_TRUE(watching.discrete(4));
  EXPECT_TRUE(s.info().frozen());
  // A console that writes the same number again and again is a program that hangs.
  EXPECT_EQ(watching.write(300, {2}), 0);
  EXPECT_EQ(watching.coil(3, true), 0);
  EXPECT_EQ(watching.input(100), kFrozen);
  int writes = 0;
  while (watching.input(100) != kFault && ++writes < 10000) {
    EXPECT_EQ(watching.write(300, {2}), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(watching.input(100), kFault);
  EXPECT_EQ(watching.coil(3, true), 0);
  EXPECT_EQ(watching.coil(1, false), 0);
  EXPECT_EQ(watching.input(100), 0);
}

TEST_F(ModbusOperator, TheOtherRadarIsLeftAlone) {
  EXPECT_EQ(master.coil(1, true, 2), 0);
  EXPECT_EQ(master.input(100, 2), kFrozen);
  EXPECT_EQ(master.input(100, 1), 0);
}

TEST(ModbusMaster, NoMoreMastersThanAllowedAndAPlaceThatIsFreeIsGivenAgain) {
  ModbusConfig config = modbus_on_any_port();
  config.max_masters = 2;
  ModbusServer s(config);
  RawMaster first(s.service.port());
  EXPECT_EQ(first.input(2), 1);
  {
    RawMaster second(s.service.port());
    EXPECT_EQ(second.input(2), 1);
    RawMaster third(s.service.port());
    EXPECT_TRUE(third.ask({4, 0, 2, 0, 1}).empty());
    EXPECT_EQ(first.input(2), 1);
  }
  int tries = 0;
  while (exception_of(RawMaster(s.service.port()).ask({4, 0, 2, 0, 1})) != 0 && ++tries < 1000)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_LT(tries, 1000);
}

TEST(ModbusMaster, OnlyListedAddressesMayCome) {
  ModbusConfig config = modbus_on_any_port();
  config.allow = {"10.0.0.0/8", "192.0.2.1"};
  ModbusServer s(config);
  EXPECT_TRUE(RawMaster(s.service.port()).ask({4, 0, 2, 0, 1}).empty());
  config.allow.emplace_back("127.0.0.0/8");
  ModbusServer open(config);
  EXPECT_EQ(RawMaster(open.service.port()).input(2), 1);
}

TEST(ModbusMaster, AMasterThatAsksNothingIsDisconnected) {
  ModbusConfig config = modbus_on_any_port();
  config.idle_timeout_s = 0.1;
  ModbusServer s(config);
  RawMaster master(s.service.port());
  EXPECT_TRUE(master.receive().empty());
}

TEST(ModbusMaster, AMasterThatDoesNotReadDoesNotHoldUpTheEnd) {
  TestServer server(small_options());
  const ModbusConfig config = modbus_on_any_port();
  // Time is not what ends anything here.
  std::optional<modbus::Service> service(std::in_place, config, modbus::reserve(config), server.panel(),
                                         std::chrono::hours(1));
  const int deaf = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int few_bytes =
      1 << 16;  // in the kernel: that nothing goes out any more soon means that nobody reads
  ASSERT_EQ(::setsockopt(deaf, SOL_SOCKET, SO_SNDBUF, &few_bytes, sizeof few_bytes), 0);
  ASSERT_EQ(::setsockopt(deaf, SOL_SOCKET, SO_RCVBUF, &few_bytes, sizeof few_bytes), 0);
  connect_to_loopback(deaf, service->port());
  const Octets request = frame_of({4, 0, 100, 0, 22});
  Octets many;
  for (int i = 0; i < 100; ++i) many.insert(many.end(), request.begin(), request.end());
  for (pollfd out{deaf, POLLOUT, 0}; ::poll(&out, 1, 2000) == 1;) {
    std::size_t sent = 0;  // a part of the requests would shift all that follow
    while (sent < many.size()) {
      const ssize_t n = ::send(deaf, many.data() + sent, many.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n < 0 && (errno != EAGAIN || ::poll(&out, 1, 2000) != 1)) break;
      if (n > 0) sent += static_cast<std::size_t>(n);
    }
    if (sent < many.size()) break;
  }
  service.reset();
  ::close(deaf);
}

TEST(ModbusMaster, AServerThatHasStoppedAnswersBusyAndChangesNothing) {
  ModbusServer s;
  RawMaster master(s.service.port());
  s.server.stop();
  EXPECT_EQ(master.coil(0, false), 6);
  EXPECT_EQ(master.input(113), 4);
  EXPECT_TRUE(s.server.panel().status(0)->transmit);
}

}  // namespace
}  // namespace obliq::test::operator_test
