#pragma once
#include <cstdint>

namespace obliq {

/// Memory of this process that is resident, from /proc/self/statm (proc(5)); 0 where that cannot be read.
std::int64_t resident_bytes();

/// The most that it ever was, from getrusage(2).
std::int64_t peak_resident_bytes();

}  // namespace obliq
