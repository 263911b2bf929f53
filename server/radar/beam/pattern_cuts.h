#pragma once
#include <filesystem>
#include <vector>

namespace obliq {

/// Gain over angle as tabulated, relative to its peak: interpolated in dB between the angles.
struct PatternCut {
  std::vector<double> angle_rad;  ///< rising
  std::vector<double> gain_db;    ///< 0 at most

  /// One-way power gain; 0 outside the table.
  double gain(double offset_rad) const;
  /// The farthest angle at which the gain is above `edge`.
  double extent_rad(double edge) const;

  bool operator==(const PatternCut&) const = default;
};

/// A measured antenna: its cuts through the boresight.
struct PatternCuts {
  std::filesystem::path path;
  PatternCut azimuth;
  PatternCut elevation;

  bool operator==(const PatternCuts&) const = default;
};

/// Reads a table with the heading cut,angle_deg,gain_db and the cuts "azimuth" and "elevation"; angles from
/// the boresight, clockwise or up positive. A file may have one cut alone. Throws InputError with file and
/// line.
PatternCuts read_pattern_cuts(const std::filesystem::path& file);

}  // namespace obliq
