#include "terrain/dem/projection.h"

#include <fmt/core.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <numbers>

#include "terrain/base/errors.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq {
namespace {

struct Destroy {
  void operator()(OGRCoordinateTransformation* t) const { OGRCoordinateTransformation::DestroyCT(t); }
};
using Transformation = std::unique_ptr<OGRCoordinateTransformation, Destroy>;

/// GRS80 and WGS84 share the semi-major axis; their flattenings differ in the ninth digit.
bool is_modern_datum(const OGRSpatialReference& crs) {
  OGRErr error = OGRERR_NONE;
  const double a = crs.GetSemiMajor(&error);
  if (error != OGRERR_NONE) return false;
  const double inverse_flattening = crs.GetInvFlattening(&error);
  return error == OGRERR_NONE && std::abs(a - 6378137.0) < 0.01 &&
         std::abs(inverse_flattening - 298.25722) < 1e-4 && crs.GetPrimeMeridian() == 0;
}

void transform(OGRCoordinateTransformation& way, std::vector<double>& x, std::vector<double>& y) {
  if (x.empty()) return;
  const GdalMessages quiet;  // a point outside a projection's domain is data here
  std::vector<int> ok(x.size(), 0);
  way.Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr, ok.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!ok[i]) x[i] = y[i] = HUGE_VAL;
  }
}

}  // namespace

struct Projection::Ways {
  Transformation forward;
  Transformation inverse;
};

Projection::~Projection() = default;
Projection::Projection(Projection&&) noexcept = default;
Projection& Projection::operator=(Projection&&) noexcept = default;

Projection::Projection(const OGRSpatialReference& crs, const std::string& field, const std::string& path)
    : ways_(std::make_unique<Ways>()) {
  const GdalMessages messages;
  OGRSpatialReference flat(crs);
  flat.StripVertical();
  flat.DemoteTo2D(nullptr);
  flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRSpatialReference geographic;
  geographic.importFromEPSG(4326);
  if (is_modern_datum(flat)) {
    const std::unique_ptr<OGRSpatialReference> own(flat.CloneGeogCS());
    if (own) {
      geographic = *own;
      geographic.SetAngularUnits(SRS_UA_DEGREE, CPLAtof(SRS_UA_DEGREE_CONV));
    }
  }
  geographic.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  ways_->forward.reset(OGRCreateCoordinateTransformation(&geographic, &flat));
  ways_->inverse.reset(OGRCreateCoordinateTransformation(&flat, &geographic));
  if (!ways_->forward || !ways_->inverse) {
    const char* name = flat.GetName();
    throw InputError(
        fmt::format("{}: found {} in the coordinate system \"{}\", which does not lead to longitude and "
                    "latitude ({}); allowed: geographic or projected systems",
                    field, path, name ? name : "", messages.reason("PROJ knows no way")));
  }
  if (flat.IsGeographic()) turn_ = 2 * std::numbers::pi / flat.GetAngularUnits();
}

void Projection::forward(std::vector<double>& x, std::vector<double>& y) const {
  transform(*ways_->forward, x, y);
}

void Projection::inverse(std::vector<double>& x, std::vector<double>& y) const {
  transform(*ways_->inverse, x, y);
}

}  // namespace obliq
