#include "terrain/base/process.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

namespace obliq {

std::int64_t bytes_in_line(const std::filesystem::path& path, std::string_view name) {
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    std::int64_t kibibytes = 0;
    if (word == name) return file >> kibibytes ? kibibytes * 1024 : 0;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

std::int64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t total = 0;
  std::int64_t resident = 0;
  if (!(file >> total >> resident)) return 0;
  return resident * ::sysconf(_SC_PAGESIZE);
}

std::int64_t peak_resident_bytes() {
  const std::int64_t peak = bytes_in_line("/proc/self/status", "VmHWM:");
  return peak > 0 ? std::max(peak, resident_bytes()) : 0;  // the kernel counts roughly
}

void give_back_freed_memory() { ::malloc_trim(0); }

bool gives_large_pages(const std::filesystem::path& path) {
  std::ifstream file(path);
  for (std::string word; file >> word;)
    if (word == "[always]" || word == "[madvise]") return true;
  return false;
}

bool lower_own_priority() {
  // About a tenth of a core beside threads that compute all the time, a whole one beside threads that wait
  // (weights of the Linux scheduler: 110 against 1024).
  constexpr int kNiceness = 10;
  // Linux: niceness belongs to the thread (setpriority(2), "C library/kernel differences").
  return setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness) == 0;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

double load_average() {
  double load = 0;
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

}  // namespace obliq
