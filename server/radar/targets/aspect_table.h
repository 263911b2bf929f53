#pragma once
#include <filesystem>
#include <vector>

namespace obliq {

/// A target's radar cross section by where it is looked at from. Immutable.
class AspectTable {
 public:
  /// A CSV with the heading aspect_deg,elevation_deg,rcs_dbsm: aspect clockwise from the nose, of both sides
  /// where all are from 0 to 180; elevation of the radar over the target's own level. Each aspect with each
  /// elevation once, in any order. Throws InputError with file and line.
  static AspectTable read(const std::filesystem::path& file);

  /// Linear in dB between its angles; beyond the elevations that there are the nearest.
  double rcs_dbsm(double aspect_deg, double elevation_deg) const;
  /// Of all values as areas, in dB.
  double mean_dbsm() const { return mean_dbsm_; }
  /// They may be areas: none is below 0.
  bool is_all_positive() const { return all_positive_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::vector<double> aspect_deg_;     ///< rising, 0 to less than 360
  std::vector<double> elevation_deg_;  ///< rising
  std::vector<double> rcs_dbsm_;       ///< [aspects][elevations]
  bool both_sides_ = false;
  bool all_positive_ = true;
  double mean_dbsm_ = 0;
};

}  // namespace obliq
