#pragma once
// frustum.quality: one word for how a frame is sampled.
#include <span>
#include <string_view>
#include <vector>

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
  bool searched = false;      ///< columns and rows are to be found; those above are a beginning
  std::string_view meaning;   ///< for whom it is, in a sentence
  std::string_view measured;  ///< error and time, on what scene
};

std::span<const QualityPreset> quality_presets();

/// Of a scene that names nothing of its frustum.
constexpr std::string_view kDefaultQuality = "standard";

/// The preset of that name, or null.
const QualityPreset* find_quality(std::string_view name);

/// The names of all presets.
std::span<const Choice> quality_choices();

/// The keys of [frustum] that the preset stands for. A number of pixels that depends on the bins is a node
/// with per_bin set and no value yet: settle_pixels() gives it one.
std::vector<ConfigNode> quality_nodes(const QualityPreset& preset, const ConfigNode& quality);

/// Pixels for so many bins, within the limits of frustum.pixel_columns and pixel_rows.
int pixels_for_bins(double per_bin, int bins);

}  // namespace obliq
