#include "server/frontier/frontier_comparison.h"

#include <algorithm>

namespace obliq {

std::vector<PaperComparison> compare_with_paper(const std::vector<FrontierRow>& rows, double scene_cell_m,
                                                Returns returns) {
  const FrontierRow* paper = find_row(rows, paper_sampling(scene_cell_m), returns);
  if (paper == nullptr || !paper->possible()) return {};
  const auto compared = [&](const FrontierRow& row) {
    const auto ratio = [](double theirs, double ours) { return ours > 0 ? theirs / ours : 0; };
    return PaperComparison{row, ratio(paper->frame_ms, row.frame_ms),
                           ratio(paper->power_error, row.power_error),
                           ratio(paper->gap_fraction, row.gap_fraction)};
  };
  std::vector<PaperComparison> table{compared(*paper)};
  for (const FrustumKind kind :
       {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::polar, FrustumKind::sweep}) {
    const FrontierRow* best = nullptr;
    const auto late = [&](const FrontierRow& row) { return row.frame_ms > paper->frame_ms; };
    for (const FrontierRow& row : rows) {
      if (!row.possible() || row.returns != returns || row.sampling.kind != kind ||
          row.sampling.cell_m != scene_cell_m)
        continue;
      const bool better = best == nullptr            ? true
                          : late(row) != late(*best) ? late(*best)
                          : late(row)                ? row.frame_ms < best->frame_ms
                                                     : row.power_error < best->power_error;
      if (better) best = &row;
    }
    if (best != nullptr && best != paper) table.push_back(compared(*best));
  }
  return table;
}

}  // namespace obliq
