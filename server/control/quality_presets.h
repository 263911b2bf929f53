#pragma once
// frustum.quality: one word for how a frame is sampled.
#include <optional>
#include <span>
#include <string_view>

#include "server/control/config_tree.h"

namespace obliq {

/// What frustum.quality stands for. Pixels are a fixed number, or so many for each bin.
struct QualityPreset {
  std::string_view name;
  std::string_view kind;
  std::string_view plates;
  int columns = 0;  ///< 0: columns_per_bin for each azimuth bin
  int rows = 0;     ///< 0: rows_per_bin for each range bin
  double columns_per_bin = 0;
  double rows_per_bin = 0;
  int sub_columns = 0;       ///< of the sweep
  bool searched = false;     ///< columns and rows are found by rendering, from those above
  std::string_view meaning;  ///< its use, in a sentence

  int columns_for(int azimuth_bins) const;
  int rows_for(int range_bins) const;
  int planes_for(int azimuth_bins) const;  ///< frustum.planes_per_bin; 0: it is no sweep
};

std::span<const QualityPreset> quality_presets();

/// Of a scene whose [frustum] is empty.
constexpr std::string_view kDefaultQuality = "standard";

/// The preset of that name, or null.
const QualityPreset* find_quality(std::string_view name);

/// The names of all presets.
std::span<const Choice> quality_choices();

/// A radar's [frustum], or the one that all radars share, with pixels and quality written out as the keys
/// that they stand for. A key that the table names in the same layer or a later one stays. Columns that are
/// named in no earlier layer than planes_per_bin decide: it becomes 0. What is not a preset or a number of
/// pixels stays too, for the reader to refuse.
struct Frustum {
  ConfigNode table;
  std::optional<bool> finds_pixels;  ///< empty: it names no pixels
};
Frustum resolved_frustum(ConfigNode table, int azimuth_bins, int range_bins);

}  // namespace obliq
