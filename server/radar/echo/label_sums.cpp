#include "server/radar/echo/label_sums.h"

#include <algorithm>

namespace obliq {

void LabelSums::restart(std::size_t bins) {
  bins_ = bins;
  rows_.clear();
  std::ranges::fill(row_of_, kNone);
}

LabelSums::Row& LabelSums::new_row(int kind) {
  row_of_[static_cast<std::size_t>(kind)] = static_cast<int>(rows_.size());
  return rows_.emplace_back(Row{kind, std::vector<double>(bins_)});
}

}  // namespace obliq
