#include "terrain/dem/seams.h"

#include <algorithm>

namespace obliq {

void Seams::close(HeightGrid& grid) {
  for (int j = 0; j < grid.nz; ++j) {
    std::vector<Share>& row = rows_[static_cast<std::size_t>(j)];
    // Stable: the shares of a node stay in the order of the files, so that sums have the same bits each time.
    std::stable_sort(row.begin(), row.end(), [](const Share& a, const Share& b) { return a.i < b.i; });
    for (std::size_t k = 0; k < row.size();) {
      const int i = row[k].i;
      double sum = 0;
      double weight = 0;
      bool owned = false;
      for (; k < row.size() && row[k].i == i; ++k) {
        sum += row[k].weight * row[k].y_m;
        weight += row[k].weight;
        owned = owned || row[k].owned;
      }
      if (owned && !grid.node_known(i, j)) grid.y_m[grid.index(i, j)] = static_cast<float>(sum / weight);
    }
  }
}

}  // namespace obliq
