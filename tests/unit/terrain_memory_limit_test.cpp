// The memory that there is: of the machine, and of control groups of both versions (cgroups(7)).
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "terrain/base/memory_limit.h"

namespace obliq::test {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

class MemoryLimit : public testing::Test {
 protected:
  MemoryLimit()
      : folder_(
            fs::path(testing::TempDir()) /
            ("memory_limit_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))),
        files_{folder_ / "meminfo", folder_ / "cgroup", folder_ / "sys"} {
    fs::remove_all(folder_);
    write("meminfo", "MemTotal:        8000000 kB\nMemFree:          100000 kB\n");
  }
  ~MemoryLimit() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  std::int64_t there_is() const { return memory_there_is_bytes(files_); }

  static constexpr std::int64_t kMachine = 8'000'000LL * 1024;

  fs::path folder_;
  MemoryFiles files_;
};

TEST_F(MemoryLimit, IsTheMachinesOutsideOfGroups) { EXPECT_EQ(there_is(), kMachine); }

TEST_F(MemoryLimit, IsTheLeastOfTheGroupsThatTheProcessIsIn) {
  write("cgroup", "0::/system.slice/obliqd.service\n");
  write("sys/system.slice/obliqd.service/memory.max", "max\n");
  write("sys/system.slice/obliqd.service/memory.high", "max\n");
  EXPECT_EQ(there_is(), kMachine);
  write("sys/system.slice/memory.max", "4000000000\n");
  EXPECT_EQ(there_is(), 4'000'000'000);
  write("sys/system.slice/obliqd.service/memory.max", "3000000000\n");
  EXPECT_EQ(there_is(), 3'000'000'000);
  write("sys/system.slice/obliqd.service/memory.high", "2000000000\n");
  EXPECT_EQ(there_is(), 2'000'000'000);
  write("sys/system.slice/other.service/memory.max", "1000\n");
  EXPECT_EQ(there_is(), 2'000'000'000);
}

TEST_F(MemoryLimit, OfAContainerIsThatOfTheRootThatItSees) {
  write("cgroup", "0::/\n");
  write("sys/memory.max", "1500000000\n");
  EXPECT_EQ(there_is(), 1'500'000'000);
}

TEST_F(MemoryLimit, OfVersionOneStandsBelowItsController) {
  write("cgroup", "9:cpu,cpuacct:/a\n4:memory:/docker/0123\n0::/\n");
  write("sys/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(there_is(), kMachine);
  write("sys/memory/docker/0123/memory.limit_in_bytes", "500000000\n");
  EXPECT_EQ(there_is(), 500'000'000);
  write("cgroup", "9:cpu,cpuacct:/a\n4:blkio,memory:/of_the_host/0123\n0::/\n");
  EXPECT_EQ(there_is(), kMachine) << "the host's name, which is not seen in here";
  write("sys/memory/memory.limit_in_bytes", "600000000\n");
  EXPECT_EQ(there_is(), 600'000'000);
}

TEST_F(MemoryLimit, OfNothingIsThreeQuartersOfWhatThereIs) {
  EXPECT_EQ(memory_limit_mb(0, files_), 6144);
  EXPECT_EQ(memory_limit_mb(300, files_), 300);
  EXPECT_EQ(memory_limit_mb(kInfinite, files_), kInfinite);
  write("cgroup", "0::/\n");
  write("sys/memory.max", "4000000000\n");
  EXPECT_EQ(memory_limit_mb(0, files_), 3000);
  EXPECT_EQ(memory_limit_mb(5000, files_), 5000) << "what the operator says counts";
}

TEST_F(MemoryLimit, IsNoneWhereTheSystemDoesNotSay) {
  fs::remove(folder_ / "meminfo");
  EXPECT_EQ(there_is(), 0);
  EXPECT_EQ(memory_limit_mb(0, files_), kInfinite);
  write("cgroup", "nonsense\n:\n0:\n0::\n");
  EXPECT_EQ(there_is(), 0);
}

TEST_F(MemoryLimit, OfThisMachineIsKnown) { EXPECT_GT(memory_there_is_bytes(), 100'000'000); }

}  // namespace
}  // namespace obliq::test
