#pragma once
// Ground between the last posts of one elevation model and the first of the next.
#include <vector>

#include "terrain/height_grid.h"

namespace obliq {

/// What the files of a mosaic say of nodes around which none of them has all four posts. Files that were cut
/// from one lattice of posts have the four between them: their weights add up to one, and the mean is what
/// interpolation across both would give. Rows may be written by different threads.
class Seams {
 public:
  struct Share {
    int i = 0;           ///< node of the row
    double y_m = 0;      ///< world y that the file's valid posts give
    double weight = 0;   ///< sum of their bilinear weights
    bool owned = false;  ///< one of them stands within half a posting
  };

  explicit Seams(const HeightGrid& grid) : rows_(static_cast<std::size_t>(grid.nz)) {}

  void add(int j, const Share& share) { rows_[static_cast<std::size_t>(j)].push_back(share); }

  /// Gives the nodes that are still unknown, and within half a posting of a post, the mean of their shares.
  void close(HeightGrid& grid);

 private:
  std::vector<std::vector<Share>> rows_;
};

}  // namespace obliq
