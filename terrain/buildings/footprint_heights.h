#pragma once
// How tall the buildings of one source are, and what is odd about the numbers.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "terrain/buildings/vector_source.h"
#include "terrain/dem/load_report.h"

namespace obliq {

constexpr double kTallest_m = 2000;  ///< twice the tallest building there is

/// What one feature says of its height.
struct FeatureHeight {
  std::optional<double> height_m;  ///< nothing where no field holds a height between 0 and 2,000 m
  std::string refused;             ///< the text that should have been one
};

/// The named field, else "height", else "building:levels" storeys of 3 m.
FeatureHeight feature_height(const VectorFeature& feature, const BuildingSourceSpec& spec);

/// Collects the heights of the buildings of one source that stand.
class SourceHeights {
 public:
  explicit SourceHeights(const BuildingSourceSpec& spec) : spec_(spec) {}

  /// A building stands.
  void add(const FeatureHeight& height, std::int64_t feature);

  std::uint64_t by_default() const { return by_default_; }

  /// Least, median and most; warns of heights that were refused and of those that look like feet.
  void report(LoadReport& report) const;

 private:
  void warn_of_feet(const BuildingHeights& found, LoadReport& report) const;

  const BuildingSourceSpec& spec_;
  std::vector<double> heights_m_;
  std::uint64_t by_default_ = 0;
  std::uint64_t refused_ = 0;
  std::string first_refused_;
};

}  // namespace obliq
