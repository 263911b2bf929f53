// The Modbus service against a master that writes its bytes itself. Addresses and codes here are those of
// server/modbus/REGISTERS.md, written out: a map that moves breaks the consoles of every site.
#include "tests/integration/modbus/modbus_fixture.h"
#include "tests/support/captured_log.h"

namespace obliq::test::server_test {
namespace {

using Words = std::vector<std::uint16_t>;

class Modbus : public testing::Test {
 protected:
  ModbusServer s;
  RawMaster master{s.service.port()};
};

TEST_F(Modbus, IntroducesItself) {
  EXPECT_EQ(master.read(4, 0, 5), (Words{0x4F42, 0x4C51, 1, 2, 1}));
  EXPECT_EQ(master.read(4, 8, 2), (Words{'m' << 8 | 'a', 'i' << 8 | 'n'}));
  EXPECT_EQ(master.read(3, 8, 2, 2), (Words{'n' << 8 | 'o', 's' << 8 | 'e'}));
}

TEST_F(Modbus, BeatsAsLongAsItLives) {
  const std::uint16_t before = master.input(5);
  EXPECT_TRUE(master.reaches(5, static_cast<std::uint16_t>(before + 2)));
}

TEST_F(Modbus, StatusStandsInHoldingRegistersTooAndCannotBeWritten) {
  EXPECT_EQ(master.read(3, 0, 3), master.read(4, 0, 3));
  EXPECT_EQ(master.read(3, 104, 4), master.read(4, 104, 4));
  EXPECT_EQ(master.write(100, {1}), 2);
  EXPECT_EQ(master.write(0, {1, 2}), 2);
}

TEST_F(Modbus, AChangeOfSeveralRegistersShowsWithApplyAndAsAWhole) {
  // 35.1234567 deg = 351234567 counts = 14EF 6A07; -120.5 deg = -1205000000 = B82D 28C0; 2500 m = 0026 25A0
  // mm.
  const Words pose{0x14EF, 0x6A07, 0xB82D, 0x28C0, 0x0026, 0x25A0};
  EXPECT_EQ(master.write(200, pose), 0);
  EXPECT_EQ(master.read(3, 200, 6), pose);  // staged
  EXPECT_NE(master.read(4, 200, 6), pose);  // not in effect
  EXPECT_EQ(s.server.panel().status(0)->config.pose.latitude_deg, 0);
  EXPECT_EQ(master.input(115), 3);
  EXPECT_TRUE(master.discrete(7));
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(master.read(4, 200, 6), pose);
  EXPECT_EQ(master.input(115), 0);
  EXPECT_FALSE(master.coil_is(2));
  const auto now = s.server.panel().status(0);
  EXPECT_EQ(now->config.pose.latitude_deg, 35.1234567);
  EXPECT_EQ(now->config.pose.longitude_deg, -120.5);
  EXPECT_EQ(now->config.pose.height_m, 2500);
  EXPECT_EQ(s.server.panel().status(1)->config.pose.height_m, 1000);  // the other unit is another radar
}

TEST_F(Modbus, ValuesOutOfLimitsAreRefusedWithAllThatCameWithThem) {
  const Words before = master.read(3, 200, 6);
  // A good latitude beside a longitude of 181 deg.
  EXPECT_EQ(master.write(200, {0, 1, 0x6BE2, 0x6880}), 3);
  EXPECT_EQ(master.read(3, 200, 6), before);
  EXPECT_EQ(master.input(113), 1);
  EXPECT_EQ(master.input(114), 202);
  EXPECT_EQ(master.input(115), 0);
  EXPECT_EQ(master.write(250, {4}), 3);               // there are four frusta
  EXPECT_EQ(master.write(244, {2}), 3);               // neither yes nor no
  EXPECT_EQ(master.write(232, {0x7FC0, 0x0000}), 3);  // NaN
  EXPECT_EQ(master.write(232, {0x0000, 0x0000}), 3);  // a wavelength of nothing
  EXPECT_EQ(master.write(232, {0xBD00, 0x0000}), 3);  // a negative one
  EXPECT_EQ(master.write(240, {0x7F80, 0x0000}), 3);  // infinite power
  EXPECT_EQ(master.coil(3, true), 0);
  EXPECT_EQ(master.input(113), 0);
  EXPECT_EQ(master.input(114), 0xFFFF);
}

TEST_F(Modbus, AWavelengthIsAFloatWithItsHighWordFirst) {
  // IEEE 754: 1.0f is 3F800000. 1 m is 0.299792458 GHz.
  EXPECT_EQ(master.write(232, {0x3F80, 0x0000}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.server.panel().status(0)->config.settings.frequency_ghz, 0.299792458);
}

TEST_F(Modbus, WhatWasNotWrittenKeepsTheDigitsThatRegistersCannotShow) {
  net::PanelChange change;
  change.settings.push_back({find_parameter("radar.frequency_ghz"), 9.87654321987654});
  change.settings.push_back({find_parameter("radar.r_max_m"), 36999.99987654});
  ASSERT_EQ(s.server.panel().change(0, change, std::chrono::seconds(20)).verdict, net::PanelVerdict::done);
  EXPECT_EQ(master.write(254, {16}), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  const auto now = s.server.panel().status(0);
  EXPECT_EQ(now->config.settings.azimuth_bins, 16);
  EXPECT_EQ(now->config.settings.frequency_ghz, 9.87654321987654);
  EXPECT_EQ(now->config.settings.r_max_m, 36999.99987654);
}

TEST_F(Modbus, ARefusedApplyLeavesTheRadarAndWhatIsStagedAsTheyWere) {
  const auto before = s.server.panel().status(0);
  EXPECT_EQ(master.write(254, {18}), 0);
  EXPECT_EQ(master.write(236, {0x0262, 0x5A00}), 0);  // r_min 40 km, beyond r_max
  EXPECT_EQ(master.coil(2, true), 3);
  EXPECT_EQ(master.input(113), 2);
  EXPECT_EQ(master.input(114), 236);
  const auto after = s.server.panel().status(0);
  EXPECT_EQ(after->settings_version, before->settings_version);
  EXPECT_EQ(after->config.settings.azimuth_bins, 20);
  EXPECT_EQ(master.read(3, 254, 1), Words{18});
  EXPECT_EQ(master.coil(4, true), 0);  // discard
  EXPECT_EQ(master.read(3, 254, 1), Words{20});
}

TEST_F(Modbus, WhatTheTerrainForbidsIsRefusedByApply) {
  EXPECT_EQ(master.write(204, {0xFFFF, 0xFFFF}), 0);  // -1 mm, below the stand-in's ground
  EXPECT_EQ(master.coil(2, true), 3);
  EXPECT_EQ(master.input(113), 2);
  EXPECT_EQ(master.input(114), 204);
  EXPECT_EQ(s.server.panel().status(0)->config.pose.height_m, 1000);
}

TEST(ModbusLimits, AFrameOverALimitOfTheServerIsRefusedByTheLimitsName) {
  const CapturedLog log;
  for (const int fault : {7, 8, 9, 10}) {
    net::ServerOptions options = small_options();
    if (fault == 7) options.max_bins = 639;
    if (fault == 8) options.max_pixels = 4095;
    if (fault == 9) options.max_memory_mb = 1;
    if (fault == 10) options.max_plan_taps = 1;
    ModbusServer s(modbus_on_any_port(), options);
    RawMaster master(s.service.port());
    EXPECT_EQ(master.write(242, {0, 3000}), 0);  // 3 dB; the radar has 640 bins and 4096 pixels already
    if (fault == 10) {
      EXPECT_EQ(master.write(261, {1}), 0);  // a Gaussian beam
    }
    EXPECT_EQ(master.coil(2, true), 3);
    EXPECT_EQ(master.input(113), fault);
    EXPECT_EQ(s.server.panel().status(0)->config.settings.gain_db, 0);
  }
  for (const char* limit :
       {"max_bins is 639: ", "max_pixels is 4095: ", "max_memory_mb is 1: ", "max_plan_taps is 1: "})
    EXPECT_NE(log.text().find("modbus unit 1: apply refused: " + std::string(limit)), std::string::npos)
        << log.text();
}

TEST_F(Modbus, HalvesOfAValueAreLookedAtByApply) {
  EXPECT_EQ(master.write(204, {0x7FFF}), 0);  // the high half of 2147 km
  EXPECT_EQ(master.coil(2, true), 3);
  EXPECT_EQ(master.input(114), 204);
  EXPECT_EQ(exception_of(master.ask({6, 0, 204, 0x00, 0x26})), 0);
  EXPECT_EQ(exception_of(master.ask({6, 0, 205, 0x25, 0xA0})), 0);
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.server.panel().status(0)->config.pose.height_m, 2500);
}

TEST_F(Modbus, MaskWriteAndWriteAndReadStageLikeTheOthers) {
  // Specification V1.1b3, 6.16: (current AND and_mask) OR (or_mask AND NOT and_mask). 20 = 0x14 becomes 0x15.
  EXPECT_EQ(exception_of(master.ask({22, 0, 254, 0xFF, 0xFE, 0x00, 0x01})), 0);
  EXPECT_EQ(master.read(3, 254, 1), Words{0x15});
  EXPECT_EQ(master.ask({23, 0, 254, 0, 2, 0, 255, 0, 1, 2, 0, 48}), (Octets{23, 4, 0, 0x15, 0, 48}));
  EXPECT_EQ(master.coil(2, true), 0);
  EXPECT_EQ(s.server.panel().status(0)->config.settings.range_bins, 48);
}

TEST_F(Modbus, BlocksAreReadAcrossGapsWhichAreZero) {
  const Words identity = master.read(4, 0, 16);
  ASSERT_EQ(identity.size(), 16u);
  EXPECT_EQ(identity[0], 0x4F42);
  EXPECT_EQ(identity[6], 0);
  EXPECT_EQ(identity[7], 0);
  EXPECT_EQ(identity[8], 'm' << 8 | 'a') << "the name follows the gap";
  const Words setpoints = master.read(3, 200, 26);
  ASSERT_EQ(setpoints.size(), 26u);
  EXPECT_EQ(setpoints[9], 0);
  EXPECT_EQ(Words(setpoints.begin() + 4, setpoints.begin() + 6), master.read(3, 204, 2));
  EXPECT_EQ(master.write(208, {0, 1, 0}), 2) << "a write names registers that there are";
}

TEST_F(Modbus, UnknownAddressesUnitsAndFunctionsHaveTheirExceptions) {
  EXPECT_EQ(exception_of(master.ask({4, 0, 50, 0, 1})), 2);         // a gap
  EXPECT_EQ(exception_of(master.ask({3, 0xFF, 0xFF, 0, 125})), 2);  // past the end
  EXPECT_EQ(exception_of(master.ask({1, 0, 0, 0, 8})), 2);
  EXPECT_EQ(exception_of(master.ask({2, 0, 0, 0, 11})), 2);
  EXPECT_EQ(master.coil(7, true), 2);
  EXPECT_EQ(master.write(209, {1}), 2);
  for (const std::uint8_t function : Octets{0, 7, 8, 11, 17, 20, 24, 43, 127}) {
    EXPECT_EQ(exception_of(master.ask({function, 0, 0, 0, 1})), 1) << int{function};
  }
  for (const std::uint8_t unit : Octets{0, 3, 255}) {
    EXPECT_EQ(exception_of(master.ask({4, 0, 0, 0, 1}, unit)), 0x0B) << int{unit};
  }
  EXPECT_EQ(master.input(2), 1);  // and the connection lives
}

TEST_F(Modbus, EveryFunctionCodeHasAnAnswerWithItsOwnCodeAndTheHighestBit) {
  for (int code = 0; code < 256; ++code) {
    const auto function = static_cast<std::uint8_t>(code);
    const bool known = (code >= 1 && code <= 6) || code == 15 || code == 16 || code == 22 || code == 23;
    // Without its data, a request of a function that there is has an illegal value.
    const Octets expected{static_cast<std::uint8_t>(function | 0x80),
                          static_cast<std::uint8_t>(known ? 3 : 1)};
    EXPECT_EQ(master.ask({function}), expected) << code;
    if (known) continue;
    EXPECT_EQ(master.ask({function, 0, 0, 0, 1}), expected) << code;
  }
  EXPECT_EQ(master.input(2), 1);
}

TEST_F(Modbus, MalformedRequestsAreRefusedAndTheNextOneIsAnswered) {
  const std::vector<Octets> malformed{
      {3},
      {3, 0, 0},
      {3, 0, 0, 0, 0},              // of nothing
      {3, 0, 0, 0, 126},            // more than a frame holds
      {3, 0, 0, 0, 1, 0},           // a byte too many
      {1, 0, 0, 7, 209},            // 2001 coils
      {5, 0, 0, 0x12, 0x34},        // neither on nor off
      {6, 0, 254, 0},               // half a value
      {15, 0, 0, 0, 2, 2, 0, 0},    // a byte count that is not the coils'
      {15, 0, 0, 0, 2, 1},          // the coils are missing
      {16, 0, 254, 0, 2, 2, 0, 1},  // fewer registers than it says
      {16, 0, 254, 0, 1, 4, 0, 1, 0, 1},
      {16, 0, 254, 0, 1, 2},
      {22, 0, 254, 0xFF, 0xFE},
      {23, 0, 254, 0, 1, 0, 255, 0, 1, 2, 0},
      {23, 0, 254, 0, 0, 0, 255, 0, 1, 2, 0, 1},
  };
  for (const Octets& request : malformed) {
    const Octets answer = master.ask(request);
    EXPECT_EQ(exception_of(answer), 3) << testing::PrintToString(request);
    EXPECT_EQ(answer.empty() ? 0 : answer[0], request[0] | 0x80);
    EXPECT_EQ(master.input(2), 1) << testing::PrintToString(request);
  }
  EXPECT_EQ(master.input(115), 0);
}

TEST_F(Modbus, PipelinedRequestsAreAllAnswered) {
  Octets three;
  for (const Octets& request : {Octets{3, 0, 2, 0, 1}, Octets{7}, Octets{3, 0, 0, 0, 1}}) {
    const Octets frame = frame_of(request, 1, 0);
    three.insert(three.end(), frame.begin(), frame.end());
  }
  master.send(three);
  EXPECT_EQ(master.receive(), (Octets{3, 2, 0, 1}));
  EXPECT_EQ(master.receive(), (Octets{0x87, 1}));
  EXPECT_EQ(master.receive(), (Octets{3, 2, 0x4F, 0x42}));
}

TEST_F(Modbus, WhatIsNoModbusIsDisconnectedAndOthersAreServed) {
  RawMaster good(s.service.port());
  for (const Octets& bytes : {Octets{'G', 'E', 'T', ' ', '/', ' ', 'H', 'T'},  // no protocol 0
                              Octets{0, 1, 0, 0, 0, 0, 1, 3},                  // nothing follows
                              Octets{0, 1, 0, 0, 0, 1, 1},                     // no function
                              Octets{0, 1, 0, 0, 0, 255, 1, 3},                // longer than a frame may be
                              Octets{0, 1, 0, 0, 0xFF, 0xFF, 1, 3}}) {
    RawMaster bad(s.service.port());
    bad.send(bytes);
    EXPECT_TRUE(bad.receive().empty()) << testing::PrintToString(bytes);
    EXPECT_EQ(good.input(2), 1);
  }
}

TEST_F(Modbus, AMasterThatSendsAByteAtATimeIsServedAndHoldsUpNobody) {
  RawMaster slow(s.service.port());
  RawMaster good(s.service.port());
  const Octets frame = frame_of({4, 0, 2, 0, 1}, 1, 0);
  for (const std::uint8_t byte : frame) {
    slow.send({byte});
    EXPECT_EQ(good.input(2), 1);
    EXPECT_EQ(good.write(254, {24}), 0);
  }
  EXPECT_EQ(slow.receive(), (Octets{4, 2, 0, 1}));
}

}  // namespace
}  // namespace obliq::test::server_test
