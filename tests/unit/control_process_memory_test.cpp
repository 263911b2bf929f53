// What the process says of its own memory. The oracle is what was allocated and touched.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "terrain/base/process.h"

namespace obliq {
namespace {

constexpr std::size_t kBlock_bytes = 300'000'000;

void touch_and_give_back() {
  void* block = ::mmap(nullptr, kBlock_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  std::memset(block, 1, kBlock_bytes);
  ::munmap(block, kBlock_bytes);
}

TEST(ProcessMemory, ThePeakRemembersMemoryThatWasGivenBack) {
  touch_and_give_back();
  EXPECT_GT(peak_resident_bytes(), std::int64_t{kBlock_bytes});
  EXPECT_LT(resident_bytes(), std::int64_t{kBlock_bytes});
}

// getrusage's ru_maxrss would say 300 MB here: a new process takes it over from its parent.
TEST(ProcessMemory, ThePeakOfTheParentIsNotThatOfItsChild) {
  touch_and_give_back();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::int64_t peak = peak_resident_bytes();
    ::_exit(peak > 0 && peak < std::int64_t{kBlock_bytes} / 2 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the child's peak counts its parent's memory";
}

}  // namespace
}  // namespace obliq
