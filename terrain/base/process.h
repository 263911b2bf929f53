#pragma once
// This process and the machine that it runs on.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace obliq {

/// Bytes by a line like "MemTotal: 8000000 kB" of such files as /proc/meminfo (proc(5)); name: with its
/// colon. 0 where there is none.
std::int64_t bytes_in_line(const std::filesystem::path& file, std::string_view name);

/// Memory of this process that is resident, from /proc/self/statm (proc(5)); 0 where that cannot be read.
std::int64_t resident_bytes();

/// The most that it ever was: VmHWM of /proc/self/status (proc(5)), 0 where that cannot be read. Not
/// getrusage's ru_maxrss, which a process inherits from the one that started it.
std::int64_t peak_resident_bytes();

/// Gives the system back what malloc has kept of freed memory: tens of milliseconds for each gigabyte, during
/// which other threads may wait for memory.
void give_back_freed_memory();

/// Whether the kernel gives pages of 2 MB to memory that asks for them (LargePages): the setting
/// transparent_hugepage/enabled, in brackets in this file, is always or madvise.
bool gives_large_pages(const std::filesystem::path& file = "/sys/kernel/mm/transparent_hugepage/enabled");

/// Makes the calling thread, and the threads that it will start, yield to others that want the processor.
/// Says whether that worked.
bool lower_own_priority();

/// The processor's name as the system reports it; "unknown processor" where it does not.
std::string processor_name();

/// Programs that wanted to run, mean over the last minute; 0 where the system does not say.
double load_average();

}  // namespace obliq
