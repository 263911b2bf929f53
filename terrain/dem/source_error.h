#pragma once
// How far the grid's surface lies from the heights that it was made of.
#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "terrain/dem/post_sample.h"
#include "terrain/dem/raster.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Sizes of the vertical distance, in world y, between the grid's surface and the source's own posts.
struct SourceError {
  std::uint64_t posts = 0;  ///< compared; 0: none, and nothing else is meaningful
  double median_m = 0;
  double p95_m = 0;  ///< 95 % are no larger
  double rms_m = 0;
  double greatest_m = 0;
};

/// Collects the distances while a grid is filled, file by file. A post counts where all nodes of its cell got
/// their heights from its own file: neither where an earlier file was there first, nor where a void was
/// filled.
class SourceErrors {
 public:
  /// About this many posts, spread evenly over the grid; no more than four a cell.
  static constexpr double kPosts = 200000;

  explicit SourceErrors(const HeightGrid& grid);

  /// Which posts of a raster to keep.
  PostSample sample(const Raster& raster) const;

  /// The kept posts that stand over cells without any known node: to be called before the file fills the
  /// grid.
  std::vector<WorldPoint> place(const PostSample& sample, const Raster& raster, const WorldFrame& frame,
                                const HeightGrid& grid) const;

  /// Their distances: to be called after the file has filled the grid, before voids are filled.
  void compare(const std::vector<WorldPoint>& points, const HeightGrid& grid);

  /// Even, hashed places (x, z) on the grid, for ground that is known everywhere.
  std::vector<glm::dvec2> places(const HeightGrid& grid) const;

  /// Over what is still ground now that the area has been cut.
  SourceError summary(const HeightGrid& grid) const;

 private:
  struct Distance {
    double x_m, z_m, error_m;
  };
  double spacing_m_;
  std::vector<Distance> distances_;
};

/// How far an elevation model is from the truth, as its maker or a survey has found.
struct DemAccuracy {
  std::string product;  ///< what it was taken for
  double rmse_m = 0;    ///< vertical; 0: not known
};

/// By the file's name, its format and its posting.
DemAccuracy dem_accuracy(const Raster& raster);

// When "auto" cells become finer than the elevation model's posting: cells between whose nodes the posts lie
// cut ridges off and fill valleys.

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
