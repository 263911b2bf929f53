#pragma once
// How much memory this process may have: by the machine, and by the control groups that it is in.
#include <cstdint>
#include <filesystem>

namespace obliq {

/// Where the system says it.
struct MemoryFiles {
  std::filesystem::path machine = "/proc/meminfo";
  std::filesystem::path membership = "/proc/self/cgroup";
  std::filesystem::path groups = "/sys/fs/cgroup";
};

/// The machine's memory, or the least limit of the process's control groups and of those that they are in,
/// whichever is less: memory.max and memory.high (cgroup v2), memory.limit_in_bytes (v1; cgroups(7)). 0: the
/// system does not say.
std::int64_t memory_there_is_bytes(const MemoryFiles& files = {});

/// What server.max_memory_mb stands for, MB: itself, or where it is 0 three quarters of the memory that there
/// is. The rest is for what estimates leave out, and for others. Infinite: no limit.
double memory_limit_mb(double max_memory_mb, const MemoryFiles& files = {});

}  // namespace obliq
