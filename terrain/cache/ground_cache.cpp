#include "terrain/cache/ground_cache.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "terrain/base/files.h"
#include "terrain/base/hash.h"
#include "terrain/base/parallel.h"

namespace obliq {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".grid";
/// What a process that was killed has left half-written is removed after this long.
constexpr std::chrono::hours kAbandoned{1};
constexpr std::size_t kPiece_posts = std::size_t{1} << 20;

/// The file: this, the key's text, the heights, the bits of water.
struct Head {
  char magic[8] = {'O', 'B', 'L', 'I', 'Q', 'G', 'R', 'D'};
  std::uint32_t format = 3;  ///< 3: sums by XXH3
  std::uint32_t key_bytes = 0;
  std::uint64_t posts = 0;
  std::uint64_t posts_filled = 0;
  std::uint64_t posts_absent = 0;
  std::uint64_t error_posts = 0;
  double error_m[4] = {};      ///< median, 95 %, rms, greatest
  std::uint64_t checksum = 0;  ///< over everything, this being 0
};
static_assert(sizeof(Head) == 88);

/// Reads and writes wholes.
struct File {
  UniqueFd fd;

  std::uint64_t size() const {
    struct stat status {};
    return ::fstat(fd.get(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  }
  bool is_regular() const {
    struct stat status {};
    return ::fstat(fd.get(), &status) == 0 && S_ISREG(status.st_mode);
  }
  bool read(void* to, std::size_t size, std::uint64_t at) const {
    return read_at(fd.get(), to, size, at) == size;
  }
  bool write(const void* from, std::size_t size) const {
    for (std::size_t done = 0; done < size;) {
      const ssize_t n = ::write(fd.get(), static_cast<const char*>(from) + done, size - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }
};

/// Calls work(piece, first post, number of posts) for pieces of the heights, on all cores.
template <typename Work>
void each_piece(std::size_t posts, const Work& work) {
  for_each_row(static_cast<int>((posts + kPiece_posts - 1) / kPiece_posts), [&](int row) {
    const std::size_t first = static_cast<std::size_t>(row) * kPiece_posts;
    work(static_cast<std::size_t>(row), first, std::min(kPiece_posts, posts - first));
  });
}

std::size_t cells_of(const HeightGrid& grid) {
  return static_cast<std::size_t>(grid.nx - 1) * static_cast<std::size_t>(grid.nz - 1);
}

/// Of everything, from the sums of the heights' pieces.
std::uint64_t checksum_of(Head head, const std::string& key, const std::vector<std::uint8_t>& water,
                          const std::vector<std::uint64_t>& pieces) {
  head.checksum = 0;
  const std::uint64_t head_sum = checksum(key.data(), key.size(), checksum(&head, sizeof head));
  const std::uint64_t before = checksum(water.data(), water.size(), head_sum);
  return checksum(pieces.data(), pieces.size() * sizeof pieces[0], before);
}

std::vector<std::uint64_t> piece_sums(const std::vector<float>& heights) {
  std::vector<std::uint64_t> sums((heights.size() + kPiece_posts - 1) / kPiece_posts);
  each_piece(heights.size(), [&](std::size_t piece, std::size_t first, std::size_t n) {
    sums[piece] = checksum(heights.data() + first, n * sizeof(float));
  });
  return sums;
}

/// What is wrong with the file; empty: nothing.
std::string read_whole(const File& file, const CacheKey& key, HeightGrid& grid, Head& head,
                       std::vector<std::uint8_t>& water) {
  const std::size_t heights_at = sizeof head + key.text().size();
  const std::uint64_t water_at = heights_at + grid.y_m.size() * sizeof(float);
  const std::uint64_t size = file.size();
  const std::uint64_t with_water = water_at + (cells_of(grid) + 7) / 8;
  if (size != water_at && size != with_water)
    return fmt::format("{} bytes instead of {} or {}", size, water_at, with_water);
  std::string text(key.text().size(), '\0');
  water.resize(size - water_at);
  if (!file.read(&head, sizeof head, 0) || !file.read(text.data(), text.size(), sizeof head) ||
      !file.read(water.data(), water.size(), water_at))
    return "it cannot be read";
  std::vector<std::uint64_t> sums((grid.y_m.size() + kPiece_posts - 1) / kPiece_posts);
  std::atomic<bool> read{true};
  each_piece(grid.y_m.size(), [&](std::size_t piece, std::size_t first, std::size_t n) {
    float* heights = grid.y_m.data() + first;
    if (!file.read(heights, n * sizeof(float), heights_at + first * sizeof(float))) read = false;
    sums[piece] = checksum(heights, n * sizeof(float));
  });
  if (!read) return "it cannot be read to its end";
  if (head.checksum != checksum_of(head, text, water, sums)) return "its checksum is wrong";
  const Head own;
  if (std::memcmp(head.magic, own.magic, sizeof own.magic) != 0 || head.format != own.format ||
      head.key_bytes != text.size() || head.posts != grid.y_m.size() || text != key.text())
    return "it holds something else";
  return {};
}

/// Removes the least recently used grids beyond the limit, but never `kept`, and what was abandoned.
void prune(const std::string& folder, const std::string& kept, std::uint64_t most_bytes) {
  struct Kept {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<Kept> grids;
  std::uint64_t total = 0;
  std::error_code error;  // another process may remove them at the same time
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const Kept file{entry.last_write_time(error), entry.file_size(error), path};
    if (error) continue;
    if (path.extension() == kSuffix) {
      total += file.bytes;
      grids.push_back(file);
    } else if (path.stem().extension() == kSuffix &&
               fs::file_time_type::clock::now() - file.used > kAbandoned) {
      fs::remove(path, error);
    }
  }
  std::ranges::sort(grids, {}, &Kept::used);
  for (const Kept& file : grids) {
    if (total <= most_bytes) return;
    if (file.path == kept) continue;
    fs::remove(file.path, error);
    total -= file.bytes;
  }
}

}  // namespace

std::string usual_cache_folder() {
  const auto inside = [](const char* base, const char* below) {
    return *base == '\0' ? std::string() : std::string(base) + below;
  };
  if (const char* folder = std::getenv("OBLIQ_CACHE_DIR")) return inside(folder, "");
  if (const char* folders = std::getenv("CACHE_DIRECTORY")) {
    const std::string all = folders;
    return all.substr(0, all.find(':'));
  }
  if (const char* base = std::getenv("XDG_CACHE_HOME"); base && *base == '/') return inside(base, "/obliq");
  if (const char* home = std::getenv("HOME")) return inside(home, "/.cache/obliq");
  return {};
}

std::string GroundCache::path_of(const CacheKey& key) const { return folder_ + "/" + key.name() + kSuffix; }

std::optional<GroundCache::Facts> GroundCache::load(const CacheKey& key, HeightGrid& grid) const {
  if (!usable(key)) return std::nullopt;
  const std::string path = path_of(key);
  const File file{
      UniqueFd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK))};  // a pipe would never open
  if (!file.fd) {
    if (errno != ENOENT && errno != ENOTDIR)
      notes_.push_back("terrain.cache: " + path + " cannot be read: " + std::strerror(errno));
    return std::nullopt;
  }
  if (!file.is_regular()) {
    notes_.push_back("terrain.cache: " + path +
                     " is not a file; while it is there, this grid is made again at each start");
    return std::nullopt;
  }
  Head head;
  std::vector<std::uint8_t> water;
  const std::string fault = read_whole(file, key, grid, head, water);
  if (!fault.empty()) {
    notes_.push_back(fmt::format("terrain.cache: {} is damaged ({}) and is made again", path, fault));
    ::unlink(path.c_str());
    return std::nullopt;
  }
  (void)::futimens(file.fd.get(), nullptr);  // used just now; in vain in a folder that is read-only
  notes_.push_back("terrain.cache: heights read from " + path);
  return Facts{head.posts_filled,
               head.posts_absent,
               {head.error_posts, head.error_m[0], head.error_m[1], head.error_m[2], head.error_m[3]},
               std::move(water)};
}

void GroundCache::store(const CacheKey& key, const HeightGrid& grid, const Facts& facts,
                        std::uint64_t most_bytes) const {
  if (!usable(key)) return;
  const SourceError& error = facts.source_error;
  Head head;
  head.key_bytes = static_cast<std::uint32_t>(key.text().size());
  head.posts = grid.y_m.size();
  head.posts_filled = facts.posts_filled;
  head.posts_absent = facts.posts_absent;
  head.error_posts = error.posts;
  const double error_m[] = {error.median_m, error.p95_m, error.rms_m, error.greatest_m};
  std::ranges::copy(error_m, head.error_m);
  head.checksum = checksum_of(head, key.text(), facts.water, piece_sums(grid.y_m));

  std::error_code made;
  fs::create_directories(folder_, made);
  const std::string path = path_of(key);
  std::string half = path + ".XXXXXX";
  const File file{UniqueFd(::mkostemp(half.data(), O_CLOEXEC))};
  bool good = file.fd && file.write(&head, sizeof head) && file.write(key.text().data(), key.text().size()) &&
              file.write(grid.y_m.data(), grid.y_m.size() * sizeof(float)) &&
              file.write(facts.water.data(), facts.water.size()) && ::fsync(file.fd.get()) == 0 &&
              ::rename(half.c_str(), path.c_str()) == 0;
  if (!good) {
    notes_.push_back(fmt::format(
        "terrain.cache: nothing can be kept in {} ({}); the next start reads the elevation models again",
        folder_, made ? made.message() : std::strerror(errno)));
    if (file.fd) ::unlink(half.c_str());
    return;
  }
  if (const UniqueFd folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)); folder)
    (void)::fsync(folder.get());
  prune(folder_, path, most_bytes);
}

}  // namespace obliq
