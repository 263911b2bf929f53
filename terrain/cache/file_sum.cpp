#include "terrain/cache/file_sum.h"

#include <cpl_vsi.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>

#include "terrain/base/files.h"
#include "terrain/base/hash.h"
#include "terrain/base/parallel.h"

namespace obliq {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSumPiece_bytes = std::int64_t{1} << 20;

/// Sum of a file whose pieces are read on all cores.
std::string contents(const std::string& path, std::int64_t size, std::int64_t most_pieces) {
  const UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) return fmt::format("{} bytes, not read", size);
  const std::int64_t pieces = (size + kSumPiece_bytes - 1) / kSumPiece_bytes;
  const bool all = pieces <= most_pieces;
  const std::int64_t n = all ? pieces : most_pieces;
  std::vector<std::uint64_t> sums(static_cast<std::size_t>(n));
  for_each_row(static_cast<int>(n), [&](int k) {
    std::vector<char> piece(static_cast<std::size_t>(std::min(size, kSumPiece_bytes)));
    const std::int64_t at =
        all ? k * kSumPiece_bytes : (size - kSumPiece_bytes) / std::max<std::int64_t>(1, n - 1) * k;
    const std::size_t read = read_at(file.get(), piece.data(), piece.size(), static_cast<std::uint64_t>(at));
    sums[static_cast<std::size_t>(k)] = checksum(piece.data(), read);
  });
  return fmt::format("{} bytes, {:016x}", size, checksum(sums.data(), sums.size() * sizeof sums[0]));
}

/// The same, from what is known of files that have not changed.
std::string remembered(const std::string& path, const struct stat& status, std::int64_t most_pieces) {
  static std::mutex mutex;
  static std::map<std::string, std::string> known;  // guarded by mutex
  constexpr std::size_t kMostKnown = 10000;
  const std::string version = fmt::format("{} {} {} {} {}.{} {}.{}", path, status.st_dev, status.st_ino,
                                          most_pieces, status.st_mtim.tv_sec, status.st_mtim.tv_nsec,
                                          status.st_ctim.tv_sec, status.st_ctim.tv_nsec);
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(version); found != known.end()) return found->second;
  }
  std::string sum = contents(path, status.st_size, most_pieces);
  const std::lock_guard lock(mutex);
  if (known.size() >= kMostKnown) known.clear();
  return known.emplace(version, std::move(sum)).first->second;
}

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string sum_of(const std::string& path, std::int64_t most_pieces) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISREG(status.st_mode)) return remembered(path, status, most_pieces);
    std::string sums;
    for (const std::string& file : files_in(path))
      if (::stat(file.c_str(), &status) == 0)
        sums += remembered(file, status, std::max<std::int64_t>(1, most_pieces / 16)) + "; ";
    return sums;
  }
  VSIStatBufL virtual_file;
  if (VSIStatL(path.c_str(), &virtual_file) != 0) return path;
  return fmt::format("{} bytes of {}", virtual_file.st_size, virtual_file.st_mtime);
}

}  // namespace

std::vector<std::string> file_sums(const std::vector<std::string>& paths) {
  const std::int64_t share =
      kMostRead_bytes / std::max<std::int64_t>(1, static_cast<std::int64_t>(paths.size()));
  std::vector<std::string> sums;
  for (const std::string& path : paths)
    sums.push_back(sum_of(path, std::max<std::int64_t>(1, share / kSumPiece_bytes)));
  return sums;
}

}  // namespace obliq
