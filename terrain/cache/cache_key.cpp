#include "terrain/cache/cache_key.h"

#include <cpl_vsi.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "terrain/base/hash.h"

namespace obliq {
namespace {

/// Contents are looked at in this many pieces, evenly spread from the first byte to the last.
constexpr std::int64_t kPieces = 64;
constexpr std::int64_t kPiece_bytes = 4096;

std::uint64_t contents(const std::string& path, std::int64_t size) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t sum = 0;
  std::vector<char> piece(static_cast<std::size_t>(kPiece_bytes));
  const bool all = size <= kPieces * kPiece_bytes;
  for (std::int64_t k = 0; k < kPieces && file; ++k) {
    file.seekg(all ? k * kPiece_bytes : (size - kPiece_bytes) / (kPieces - 1) * k);
    file.read(piece.data(), kPiece_bytes);
    sum = checksum(piece.data(), static_cast<std::size_t>(file.gcount()), sum);
    if (all && file.eof()) break;
  }
  return sum;
}

}  // namespace

void CacheKey::add(std::string_view name, std::string_view value) {
  text_.append(name).append(" = ").append(value).append("\n");
}

void CacheKey::add(std::string_view name, double value) {
  const std::string text = fmt::format("{:a} ({:.9g})", value, value);
  add(name, text);
}

void CacheKey::add(std::string_view name, const std::vector<double>& values) {
  add(name,
      fmt::format("{} {:016x}", values.size(), checksum(values.data(), values.size() * sizeof(double))));
}

void CacheKey::add_file(const std::string& path) {
  struct stat local {};
  if (::stat(path.c_str(), &local) == 0 && S_ISREG(local.st_mode)) {
    add(path, fmt::format("{} bytes of {}.{}, {:016x}", local.st_size, local.st_mtim.tv_sec,
                          local.st_mtim.tv_nsec, contents(path, local.st_size)));
    newest_change_s_ = std::max(newest_change_s_, static_cast<double>(local.st_ctim.tv_sec) +
                                                      1e-9 * static_cast<double>(local.st_ctim.tv_nsec));
    return;
  }
  VSIStatBufL virtual_file;
  if (VSIStatL(path.c_str(), &virtual_file) != 0 || virtual_file.st_mtime == 0) return refuse();
  add(path, fmt::format("{} bytes of {}", virtual_file.st_size, virtual_file.st_mtime));
}

std::string CacheKey::name() const {
  return fmt::format("{:016x}{:016x}", checksum(text_.data(), text_.size(), 1),
                     checksum(text_.data(), text_.size(), 2));
}

}  // namespace obliq
