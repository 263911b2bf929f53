#pragma once
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace obliq::test {

struct ProcessMemory {
  std::uint64_t address_space_bytes = 0;
  std::uint64_t resident_bytes = 0;
};

/// What /proc says about a process (proc(5)); zeros where it says nothing.
inline ProcessMemory memory_of(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::uint64_t pages = 0;
  std::uint64_t resident_pages = 0;
  if (!(file >> pages >> resident_pages)) return {};
  const auto page_bytes = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return {pages * page_bytes, resident_pages * page_bytes};
}

}  // namespace obliq::test
