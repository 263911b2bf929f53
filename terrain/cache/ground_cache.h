#pragma once
// Grids that were made once, in files of a folder: heights with a checksum over everything and the key that
// they belong to.
#include <optional>
#include <string>
#include <vector>

#include "terrain/cache/cache_key.h"
#include "terrain/dem/source_error.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Where the cache is when the scene does not say: $OBLIQ_CACHE_DIR, else $CACHE_DIRECTORY (systemd's), else
/// $XDG_CACHE_HOME/obliq, else $HOME/.cache/obliq. Empty, for no cache, when the first of them that is set is
/// empty, or none is set.
std::string usual_cache_folder();

/// Several processes may share a folder: files come whole under their names, and are deleted when no process
/// reads them. What goes wrong is a note for the operator, never a failure.
class GroundCache {
 public:
  /// What is known of a grid besides its heights.
  struct Facts {
    std::uint64_t posts_filled = 0;
    std::uint64_t posts_absent = 0;
    SourceError source_error;
    std::vector<std::uint8_t> water;  ///< bits of cells (terrain/dem/water_cells.h)
  };

  /// The oldest grids go when all of them together are larger than this.
  static constexpr std::uint64_t kMost_bytes = std::uint64_t{2} << 30;

  /// Empty folder: no cache.
  GroundCache(std::string folder, std::vector<std::string>& notes)
      : folder_(std::move(folder)), notes_(notes) {}

  bool in_use() const { return !folder_.empty(); }

  /// Gives the grid, whose size and place are part of the key, its heights. A file that is damaged is said to
  /// be, and removed; the grid's heights are then whatever they are.
  std::optional<Facts> load(const CacheKey& key, HeightGrid& grid) const;

  /// Keeps a grid, and removes the oldest ones beyond `most_bytes`.
  void store(const CacheKey& key, const HeightGrid& grid, const Facts& facts,
             std::uint64_t most_bytes = kMost_bytes) const;

 private:
  std::string path_of(const CacheKey& key) const;
  bool usable(const CacheKey& key) const { return in_use() && key.usable(); }

  std::string folder_;
  std::vector<std::string>& notes_;
};

}  // namespace obliq
