// The register map, its page, and how values stand in registers.
#include "server/modbus/register_map.h"

#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <map>
#include <sstream>

#include "server/modbus/encoding.h"
#include "server/modbus/request.h"
#include "server/security/networks.h"

namespace obliq::modbus::register_map_test {
namespace {

using Words = std::vector<std::uint16_t>;

TEST(ModbusMap, ThePageInTheRepositoryIsTheTable) {
  std::ifstream file(OBLIQ_SOURCE_DIR "/server/modbus/REGISTERS.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), registers_markdown()) << "run: cmake --build --preset release --target generated";
}

TEST(ModbusMap, NoRegisterMeansTwoThings) {
  std::map<int, std::string> owner;
  const auto take = [&](int address, int count, std::string_view name) {
    for (int i = 0; i < count; ++i) {
      EXPECT_TRUE(owner.emplace(address + i, name).second)
          << address + i << ": " << name << " and " << owner[address + i];
      EXPECT_LT(address + i, kRegisters);
    }
  };
  for (const StatusRegister& r : status_registers()) take(r.address, width(r.words), r.name);
  for (const Setpoint& s : setpoints()) take(s.address, width(s.words), s.name);
  take(kNameAddress, kNameRegisters, "name");
  take(kConsoleHeartbeat, 1, "console_heartbeat");
}

TEST(ModbusMap, EveryParametersLimitsFitItsRegisters) {
  for (const Setpoint& s : setpoints()) {
    if (s.parameter == nullptr) continue;
    RadarConfig config;
    const Slot slot = s.parameter->slot(config);
    for (const double limit : {s.parameter->key.limits.low, s.parameter->key.limits.high}) {
      if (double* const* real = std::get_if<double*>(&slot)) {
        **real = limit == s.parameter->key.limits.low && s.parameter->key.limits.low_open ? 0.001 : limit;
      } else if (const auto* open = std::get_if<std::optional<double>*>(&slot)) {
        **open = limit;
      } else if (int* const* integer = std::get_if<int*>(&slot)) {
        **integer = static_cast<int>(limit);
      } else {
        continue;
      }
      const auto value = decode(*s.parameter, encode(*s.parameter, config));
      ASSERT_TRUE(value) << s.name << " at " << limit;
      RadarConfig back;
      ASSERT_FALSE(store(s.parameter->key, s.parameter->slot(back), *value)) << s.name;
      if (s.words == ModbusWords::i32 || s.words == ModbusWords::u16) {
        EXPECT_EQ(toml_text(value_of(*s.parameter, back)), toml_text(value_of(*s.parameter, config)))
            << s.name;
      }
    }
  }
}

TEST(ModbusMap, AVelocityThatIsNotGivenIsTheLeastCount) {
  const Parameter& north = *find_parameter("antenna.velocity_north_m_s");
  RadarConfig config;
  EXPECT_EQ(encode(north, config), (Words{0x8000, 0x0000}));
  EXPECT_EQ(decode(north, Words{0x8000, 0x0000}), Value(std::string("auto")));
  EXPECT_FALSE(decode(north, Words{0x8000, 0x0001})) << "beyond its limits";
  config.pose.velocity_north_m_s = -1.5;
  EXPECT_EQ(encode(north, config), (Words{0xFFFF, 0xFA24}));
  EXPECT_EQ(decode(north, Words{0xFFFF, 0xFA24}), Value(-1.5));
  EXPECT_FALSE(decode(*find_parameter("antenna.heading_deg"), Words{0x8000, 0x0000}));
}

TEST(ModbusMap, NumbersStandHighWordFirst) {
  EXPECT_EQ(encode_number(1, ModbusWords::f32, 1), (Words{0x3F80, 0x0000}));  // IEEE 754
  EXPECT_EQ(encode_number(-2.5, ModbusWords::f32, 1), (Words{0xC020, 0x0000}));
  EXPECT_EQ(encode_number(-1, ModbusWords::i32, 1e3), (Words{0xFFFF, 0xFC18}));  // -1000
  EXPECT_EQ(encode_number(70000, ModbusWords::u32, 1), (Words{0x0001, 0x1170}));
}

TEST(ModbusMap, NumbersTooLargeForTheirRegistersStayAtTheEnd) {
  EXPECT_EQ(encode_number(1e9, ModbusWords::u16, 1), Words{0xFFFF});
  EXPECT_EQ(encode_number(-1, ModbusWords::u16, 1), Words{0});
  EXPECT_EQ(encode_number(1e30, ModbusWords::u32, 1), (Words{0xFFFF, 0xFFFF}));
  EXPECT_EQ(encode_number(-1e30, ModbusWords::i32, 1), (Words{0x8000, 0x0000}));
  EXPECT_EQ(encode_number(std::numeric_limits<double>::quiet_NaN(), ModbusWords::u16, 1), Words{0});
}

TEST(ModbusMap, WholeNumbersOf64BitsKeepAllOfThem) {
  RadarConfig config;
  config.settings.speckle_seed = -2;
  config.pose.pose_id = 0xFFFF'FFFF'FFFF'FFFDULL;
  EXPECT_EQ(encode(*find_parameter("radar.speckle_seed"), config), (Words{0xFFFF, 0xFFFF, 0xFFFF, 0xFFFE}));
  EXPECT_EQ(encode(*find_parameter("antenna.pose_id"), config), (Words{0xFFFF, 0xFFFF, 0xFFFF, 0xFFFD}));
  EXPECT_EQ(decode(*find_parameter("radar.speckle_seed"), Words{0xFFFF, 0xFFFF, 0xFFFF, 0xFFFE}),
            std::optional<Value>(std::int64_t{-2}));
}

TEST(Networks, HoldTheirAddressesAndNoOthers) {
  EXPECT_TRUE(security::is_within("10.0.0.255", {"10.0.0.0/24"}));
  EXPECT_FALSE(security::is_within("10.0.1.0", {"10.0.0.0/24"}));
  EXPECT_TRUE(security::is_within("10.0.1.0", {"10.0.0.0/23"}));
  EXPECT_TRUE(security::is_within("::ffff:10.0.0.7", {"10.0.0.0/24"}));
  EXPECT_TRUE(security::is_within("1.2.3.4", {"0.0.0.0/0"}));
  EXPECT_FALSE(security::is_within("::1", {"0.0.0.0/0"}));
  EXPECT_TRUE(security::is_within("fd00:1::5", {"192.0.2.1", "fd00::/8"}));
  EXPECT_FALSE(security::is_within("fe00::5", {"fd00::/8"}));
  EXPECT_FALSE(security::is_within("192.0.2.2", {"192.0.2.1"}));
  EXPECT_FALSE(security::is_within("nonsense", {"0.0.0.0/0"}));
  EXPECT_FALSE(security::is_within("1.2.3.4", {}));
}

TEST(Networks, AreToldFromWhatIsNone) {
  for (const char* good : {"10.0.0.0/24", "10.1.2.3", "::1", "fd00::/8", "0.0.0.0/0", "10.1.2.3/32"})
    EXPECT_TRUE(security::is_network(good)) << good;
  for (const char* bad :
       {"", "10.0.0.1/24", "10.0.0.0/33", "10.0.0/24", "fd00::1/8", "host", "10.0.0.0/", "/8"})
    EXPECT_FALSE(security::is_network(bad)) << bad;
}

TEST(Networks, LoopbackIsToldFromElsewhere) {
  for (const char* here : {"127.0.0.1", "127.9.9.9", "::1", "localhost", "::ffff:127.0.0.1"})
    EXPECT_TRUE(security::is_loopback_address(here)) << here;
  for (const char* elsewhere : {"0.0.0.0", "::", "10.0.0.1", "example.org", ""})
    EXPECT_FALSE(security::is_loopback_address(elsewhere)) << elsewhere;
}

}  // namespace
}  // namespace obliq::modbus::register_map_test
