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

/// Forgets how much memory this process has had at most; false where the system has no such thing (proc(5),
/// clear_refs).
inline bool restart_peak_memory() {
  return static_cast<bool>(std::ofstream("/proc/self/clear_refs") << 5 << std::flush);
}

/// The most that has been resident of this process since then (VmHWM); 0 where /proc says nothing.
inline std::uint64_t peak_memory_bytes() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    std::uint64_t kilobytes = 0;
    if (word == "VmHWM:" && file >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

}  // namespace obliq::test
