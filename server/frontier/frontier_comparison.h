#pragma once
#include <vector>

#include "server/frontier/frontier_table.h"

namespace obliq {

/// A sampling against the paper's setting, over the same ground, in the same run, for one part of the
/// returns.
struct PaperComparison {
  FrontierRow row;
  double time_ratio = 0;   ///< the paper's frame time over this one's: above 1 is quicker
  double error_ratio = 0;  ///< the paper's E over this one's: above 1 is closer to the truth
  double gap_ratio = 0;    ///< the same of gap fractions; 0 when this one has no gaps
};

/// First the paper's setting itself, then for each kind the row of least E that takes no more time (the
/// quickest one where all take more). Empty when the paper's setting cannot see the scene.
std::vector<PaperComparison> compare_with_paper(const std::vector<FrontierRow>& rows, double scene_cell_m,
                                                Returns returns = Returns::all);

}  // namespace obliq
