#pragma once
// Longitude and latitude to a file's own coordinates and back.
#include <memory>
#include <string>
#include <vector>

class OGRSpatialReference;

namespace obliq {

/// One file's coordinate reference system seen from longitude and latitude on WGS84 in degrees. NAD83, ETRS89
/// and other frames on the GRS80 or WGS84 ellipsoid are taken as equal to WGS84: they differ by a metre or
/// two, and PROJ's choice among the published shifts depends on which grids a machine has. Older datums
/// (NAD27, ...) are shifted by PROJ. Vertical parts are ignored. Not for concurrent use.
class Projection {
 public:
  /// Throws InputError "FIELD: found PATH ..." when PROJ knows no way to or from this system.
  Projection(const OGRSpatialReference& crs, const std::string& field, const std::string& path);
  ~Projection();
  Projection(Projection&&) noexcept;
  Projection& operator=(Projection&&) noexcept;

  /// In place: longitude to x (east), latitude to y (north). Points that have no image become infinite.
  void forward(std::vector<double>& x, std::vector<double>& y) const;
  /// In place: x to longitude, y to latitude, degrees.
  void inverse(std::vector<double>& x, std::vector<double>& y) const;

  /// Full turn in the units of x when x is a longitude; 0 for projected systems.
  double turn() const { return turn_; }

 private:
  struct Ways;
  std::unique_ptr<Ways> ways_;
  double turn_ = 0;
};

}  // namespace obliq
