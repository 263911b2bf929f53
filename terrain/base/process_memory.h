#pragma once
#include <cstdint>

namespace obliq {

/// Memory of this process that is resident, from /proc/self/statm (proc(5)); 0 where that cannot be read.
std::int64_t resident_bytes();

/// The most that it ever was: VmHWM of /proc/self/status (proc(5)), 0 where that cannot be read. Not
/// getrusage's ru_maxrss, which a process inherits from the one that started it.
std::int64_t peak_resident_bytes();

}  // namespace obliq
