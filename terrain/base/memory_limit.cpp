#include "terrain/base/memory_limit.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "terrain/base/process.h"

namespace obliq {
namespace {

constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::max();
constexpr double kShare = 0.75;

/// "max" is none, and so is a file that is not there.
std::int64_t limit_in(const std::filesystem::path& path) {
  std::int64_t bytes = 0;
  return std::ifstream(path) >> bytes && bytes > 0 ? bytes : kUnknown;
}

/// Of a group below `root`, and of those that it is in. In a container the host's name of a group may lead
/// nowhere, and `root` is the group itself.
std::int64_t limit_of(const std::filesystem::path& root, const std::string& group) {
  std::int64_t least = kUnknown;
  std::filesystem::path below = std::filesystem::path(group).lexically_normal().relative_path();
  while (true) {
    for (const char* name : {"memory.max", "memory.high", "memory.limit_in_bytes"})
      least = std::min(least, limit_in(root / below / name));
    if (below.empty()) return least;
    below = below.parent_path();
  }
}

}  // namespace

std::int64_t memory_there_is_bytes(const MemoryFiles& files) {
  const std::int64_t machine = bytes_in_line(files.machine, "MemTotal:");
  std::int64_t least = machine > 0 ? machine : kUnknown;
  // hierarchy:controllers:group (cgroups(7), "/proc files").
  std::ifstream membership(files.membership);
  for (std::string line; std::getline(membership, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") {
      least = std::min({least, limit_of(files.groups, group), limit_of(files.groups / "unified", group)});
    } else if (controllers.find(",memory,") != std::string::npos) {
      least = std::min(least, limit_of(files.groups / "memory", group));
    }
  }
  return least == kUnknown ? 0 : least;
}

double memory_limit_mb(double max_memory_mb, const MemoryFiles& files) {
  if (max_memory_mb > 0) return max_memory_mb;
  const std::int64_t bytes = memory_there_is_bytes(files);
  return bytes > 0 ? std::floor(kShare * static_cast<double>(bytes) / 1e6)
                   : std::numeric_limits<double>::infinity();
}

}  // namespace obliq
