#include "server/radar/echo/label_sums.h"

#include <algorithm>
#include <utility>

namespace obliq {

void LabelSums::restart(std::size_t bins) {
  bins_ = bins;
  for (Row& row : rows_) spare_.push_back(std::move(row.sum));
  rows_.clear();
  std::ranges::fill(row_of_, kNone);
}

LabelSums::Row& LabelSums::new_row(int kind) {
  row_of_[static_cast<std::size_t>(kind)] = static_cast<int>(rows_.size());
  Row& row = rows_.emplace_back(Row{kind, {}});
  if (!spare_.empty()) {
    row.sum = std::move(spare_.back());
    spare_.pop_back();
  }
  row.sum.assign(bins_, 0);
  return row;
}

}  // namespace obliq
