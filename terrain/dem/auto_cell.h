#pragma once
// When "auto" cells become finer than the elevation model's posting: cells between whose nodes the posts lie
// cut ridges off and fill valleys.
#include <string>

#include "terrain/dem/source_error.h"

namespace obliq {

/// How far an automatic grid may go.
struct AutoCellLimits {
  DemAccuracy accuracy;    ///< of the best elevation model
  double coarsest_m = 0;   ///< what the posting and the radars' sampling ask for
  double footprint_m = 0;  ///< of the radars' sampling on the ground; 0: no radar
  double most_posts = 0;   ///< 0: cells never become finer
};

/// 95 % of the model's posts are to lie this close to the grid: the larger of 0.5 m and half the model's own
/// error, which adds an eighth to it.
double allowed_error_m(const DemAccuracy& accuracy);

/// A frame's time with cells of half the size, as a multiple of that with these. Deterministic: a model of
/// what is marched, not a measurement.
double halving_time(double cell_m, double footprint_m);
constexpr double kMostHalvingTime = 1.3;

/// Half of cell_m, or 0 where the grid is good or a limit is met; `left` is told which, if any.
double finer_cell_m(const AutoCellLimits& limits, double cell_m, double posts, const SourceError& error,
                    std::string& left);

}  // namespace obliq
