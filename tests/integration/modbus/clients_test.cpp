// obliqd against Modbus masters that no one here wrote: mbpoll and pymodbus.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/daemon.h"

namespace obliq::test::clients_test {
namespace {

constexpr auto kScene = R"(
[terrain]
synthetic = "flat"
[antenna]
height_m = 1000.0
[radar]
r_min_m = 2000.0
r_max_m = 5000.0
sector_deg = 60.0
[frustum]
kind = "oblique"
pixels = 32
[bins]
azimuth = 16
range = 32
[server]
port = 0
[http]
port = 0
[modbus]
enabled = true
port = 0
)";

/// An obliqd with Modbus on.
struct Console {
  explicit Console(const std::string& scene = kScene)
      : daemon({"--config", folder.write("scene.toml", scene)}, folder.path()) {
    const std::string log = daemon.log();
    const std::string mark = "modbus: on 127.0.0.1:";
    const std::size_t at = log.find(mark);
    EXPECT_NE(at, std::string::npos) << log;
    if (at != std::string::npos) port = log.substr(at + mark.size(), log.find(',', at) - at - mark.size());
  }

  Outcome mbpoll(const std::vector<std::string>& words) const {
    std::vector<std::string> arguments{"-m", "tcp", "-p", port, "-0", "-1", "-q", "-B", "-o", "10"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    return run_program("/usr/bin/mbpoll", arguments, folder.path());
  }

  TestFolder folder;
  Daemon daemon;
  std::string port;
};

bool says(const Outcome& outcome, const std::string& text) {
  return (outcome.out + outcome.err).find(text) != std::string::npos;
}

TEST(ModbusClients, MbpollReadsWritesAndApplies) {
  if (!std::filesystem::exists("/usr/bin/mbpoll")) GTEST_SKIP() << "mbpoll is not installed";
  const Console console;
  const Outcome identity = console.mbpoll({"-t", "3:hex", "-r", "0", "-c", "3", "127.0.0.1"});
  EXPECT_EQ(identity.code, 0) << identity.err;
  EXPECT_TRUE(says(identity, "0x4F42") && says(identity, "0x4C51")) << identity.out;

  const auto setpoint = [&](const std::string& table) {
    return console.mbpoll({"-t", table, "-r", "204", "-c", "1", "127.0.0.1"});
  };
  EXPECT_TRUE(says(setpoint("3:int"), "1000000")) << "1000 m in mm";
  const Outcome written = console.mbpoll({"-t", "4:int", "-r", "204", "127.0.0.1", "2500000"});
  EXPECT_EQ(written.code, 0) << written.err;
  EXPECT_TRUE(says(setpoint("4:int"), "2500000"));
  EXPECT_TRUE(says(setpoint("3:int"), "1000000"));
  EXPECT_EQ(console.mbpoll({"-t", "0", "-r", "2", "127.0.0.1", "1"}).code, 0);
  EXPECT_TRUE(says(setpoint("3:int"), "2500000"));

  const Outcome wavelength = console.mbpoll({"-t", "3:float", "-r", "232", "-c", "1", "127.0.0.1"});
  EXPECT_TRUE(says(wavelength, "0.0299792")) << wavelength.out;  // 10 GHz
}

TEST(ModbusClients, MbpollIsToldWhyItIsRefused) {
  if (!std::filesystem::exists("/usr/bin/mbpoll")) GTEST_SKIP() << "mbpoll is not installed";
  const Console console;
  const Outcome value = console.mbpoll({"-t", "4:int", "-r", "204", "127.0.0.1", "2000000000"});
  EXPECT_NE(value.code, 0);
  EXPECT_TRUE(says(value, "Illegal data value")) << value.err << value.out;
  const Outcome address = console.mbpoll({"-t", "4", "-r", "60", "127.0.0.1"});
  EXPECT_TRUE(says(address, "Illegal data address")) << address.err << address.out;
}

TEST(ModbusClients, PymodbusWritesAndReadsBackEverySetpointOfThePage) {
  const Console console;
  const Outcome outcome = run_program("/bin/bash",
                                      {OBLIQ_SOURCE_DIR "/tests/integration/modbus/modbus_pymodbus.sh",
                                       OBLIQ_BINARY_DIR, "127.0.0.1", console.port},
                                      console.folder.path());
  if (outcome.code == 77) GTEST_SKIP() << outcome.err;
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
}

TEST(ModbusClients, OffLoopbackItNeedsAFlagAndAListOfWhoMayCome) {
  const TestFolder folder;
  const auto refusal = [&](const std::string& keys) {
    const std::string scene = std::string(kScene) + keys;
    return run_program(OBLIQD_PROGRAM, {"--config", folder.write("scene.toml", scene), "--check-config"},
                       folder.path());
  };
  const std::string address = "address = \"0.0.0.0\"\n";
  for (const std::string& keys :
       {address, address + "unprotected = true\n", address + "allow = [\"10.0.0.0/24\"]\n"}) {
    const Outcome outcome = refusal(keys);
    EXPECT_EQ(outcome.code, 1) << keys;
    EXPECT_TRUE(says(outcome, "modbus.address") && says(outcome, "modbus.unprotected")) << outcome.err;
  }
  const Outcome bad = refusal("allow = [\"10.0.0.1/24\"]\n");
  EXPECT_EQ(bad.code, 1);
  EXPECT_TRUE(says(bad, "modbus.allow")) << bad.err;
  EXPECT_EQ(refusal(address + "unprotected = true\nallow = [\"10.0.0.0/24\", \"192.0.2.7\"]\n").code, 0);
}

TEST(ModbusClients, APortInUseIsAMistakeToHearOfAtOnce) {
  const Console console;
  const TestFolder folder;
  const Outcome outcome =
      run_program(OBLIQD_PROGRAM,
                  {"--config", folder.write("scene.toml", kScene), "--set", "modbus.port=" + console.port},
                  folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(says(outcome, console.port)) << outcome.err;
}

}  // namespace
}  // namespace obliq::test::clients_test
