#include "terrain/parallel.h"

#include <tbb/parallel_for.h>

namespace obliq {

void for_each_row(int n_rows, const std::function<void(int row)>& work) {
  if (n_rows <= 0) return;
  tbb::parallel_for(0, n_rows, [&](int row) { work(row); });
}

}  // namespace obliq
