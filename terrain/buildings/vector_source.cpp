#include "terrain/buildings/vector_source.h"

#include <fmt/core.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/dem/gdal_messages.h"
#include "terrain/dem/projection.h"

namespace obliq {
namespace {

using Dataset = std::unique_ptr<GDALDataset>;

[[noreturn]] void refuse(const VectorQuery& query, const std::string& what, const std::string& allowed) {
  throw InputError(fmt::format("{}: found {}: {}; allowed: {}", query.key,
                               query.path.empty() ? "an empty name" : query.path, what, allowed));
}

Dataset opened(const VectorQuery& query) {
  refuse_endless_file(query.key + ": " + query.path, query.path);
  const GdalMessages messages;
  Dataset dataset(
      GDALDataset::Open(query.path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (!dataset) {
    const std::string reason = messages.reason_without(query.path, "it cannot be opened");
    const Dataset raster(GDALDataset::Open(query.path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    if (raster) refuse(query, "it holds a raster only", "polygons, or a class raster with its classes named");
    refuse(query, reason, "a vector source that OGR can open");
  }
  if (dataset->GetLayerCount() == 0) refuse(query, "it has no layer", "a source of polygons");
  return dataset;
}

OGRLayer& chosen_layer(GDALDataset& dataset, const VectorQuery& query) {
  const GdalMessages messages;
  OGRLayer* layer = query.layer.empty() ? dataset.GetLayer(0) : dataset.GetLayerByName(query.layer.c_str());
  if (!layer) {
    std::string names;
    for (auto* each : dataset.GetLayers())
      names += (names.empty() ? "" : ", ") + std::string(each->GetName());
    refuse(query, "it has no layer \"" + query.layer + "\"", "one of " + names);
  }
  // A table of text. Nothing that it says is shown: its field names may be the first line of any file.
  if (layer->GetGeomType() == wkbNone) refuse(query, "its layer has no shapes", "a source of polygons");
  if (!query.where.empty() && layer->SetAttributeFilter(query.where.c_str()) != OGRERR_NONE)
    refuse(query, "its filter \"" + query.where + "\" is not understood: " + messages.reason("bad filter"),
           "an OGR attribute filter, such as \"natural = 'water'\"");
  return *layer;
}

/// Names of the layer's fields, the first few of very many.
std::string field_names(OGRLayer& layer) {
  constexpr int kMost = 40;
  const OGRFeatureDefn& fields = *layer.GetLayerDefn();
  std::string names;
  for (int n = 0; n < std::min(kMost, fields.GetFieldCount()); ++n)
    names += (names.empty() ? "" : ", ") + std::string(fields.GetFieldDefn(n)->GetNameRef());
  if (fields.GetFieldCount() > kMost) names += " and more";
  return names.empty() ? "none" : names;
}

/// Tags of OpenStreetMap may hide in one field; which there are shows in the features alone.
void require_field(OGRLayer& layer, const VectorQuery& query) {
  const OGRFeatureDefn& fields = *layer.GetLayerDefn();
  if (query.field.empty() || fields.GetFieldIndex(query.field.c_str()) >= 0 ||
      fields.GetFieldIndex("other_tags") >= 0)
    return;
  refuse(query, "it has no field \"" + query.field + "\"", "one of its fields: " + field_names(layer));
}

/// The layer's system, or longitude and latitude when it names none and its extent fits.
Projection projection_of(OGRLayer& layer, const VectorQuery& query, std::vector<std::string>& notes) {
  const GdalMessages quiet;
  if (const OGRSpatialReference* crs = layer.GetSpatialRef(); crs && !crs->IsEmpty())
    return Projection(*crs, query.key, query.path);
  OGREnvelope box;
  const bool has_extent = layer.GetExtent(&box, TRUE) == OGRERR_NONE;
  if (has_extent && !(box.MinX >= -360 && box.MaxX <= 360 && box.MinY >= -90 && box.MaxY <= 90))
    refuse(query, "it carries no coordinate system and its numbers are not degrees",
           "a source that names its coordinate system");
  notes.push_back(query.path + " carries no coordinate system; taken as longitude and latitude");
  OGRSpatialReference degrees;
  degrees.importFromEPSG(4326);
  return Projection(degrees, query.key, query.path);
}

void add_ring(const OGRLineString& line, GeoPolygon& polygon) {
  int n = line.getNumPoints();
  const auto same = [&](int a, int b) {
    return line.getX(a) == line.getX(b) && line.getY(a) == line.getY(b);
  };
  while (n > 1 && same(n - 1, 0)) --n;
  std::vector<LonLat>& ring = polygon.rings.emplace_back();
  ring.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) ring.push_back({line.getX(i), line.getY(i)});
}

void collect(const OGRGeometry& geometry, std::vector<GeoPolygon>& polygons) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon || type == wkbTriangle) {
    const OGRPolygon& p = *geometry.toPolygon();
    if (!p.getExteriorRing()) return;
    GeoPolygon& polygon = polygons.emplace_back();
    add_ring(*p.getExteriorRing(), polygon);
    for (int i = 0; i < p.getNumInteriorRings(); ++i) add_ring(*p.getInteriorRing(i), polygon);
  } else if (type == wkbLineString) {
    const OGRLineString& line = *geometry.toLineString();
    if (line.getNumPoints() >= 4 && line.get_IsClosed()) add_ring(line, polygons.emplace_back());
  } else if (type == wkbTIN || type == wkbPolyhedralSurface) {
    const OGRPolyhedralSurface& surface = *geometry.toPolyhedralSurface();
    for (int i = 0; i < surface.getNumGeometries(); ++i) collect(*surface.getGeometryRef(i), polygons);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    const OGRGeometryCollection& parts = *geometry.toGeometryCollection();
    for (int i = 0; i < parts.getNumGeometries(); ++i) collect(*parts.getGeometryRef(i), polygons);
  }
}

std::vector<GeoPolygon> polygons_of(OGRFeature& feature) {
  std::vector<GeoPolygon> polygons;
  const OGRGeometry* geometry = feature.GetGeometryRef();
  if (!geometry) return polygons;
  if (geometry->hasCurveGeometry()) {
    const std::unique_ptr<OGRGeometry> straight(geometry->getLinearGeometry());
    if (straight) collect(*straight, polygons);
  } else {
    collect(*geometry, polygons);
  }
  return polygons;
}

void to_lonlat(const Projection& projection, std::vector<GeoPolygon>& polygons, std::vector<double>& x,
               std::vector<double>& y) {
  x.clear();
  y.clear();
  for (const GeoPolygon& polygon : polygons) {
    for (const auto& ring : polygon.rings) {
      for (const LonLat& p : ring) {
        x.push_back(p.longitude_deg);
        y.push_back(p.latitude_deg);
      }
    }
  }
  projection.inverse(x, y);
  std::size_t n = 0;
  for (GeoPolygon& polygon : polygons) {
    for (auto& ring : polygon.rings) {
      for (LonLat& p : ring) {
        p = {x[n], y[n]};
        ++n;
      }
    }
  }
}

/// Lets sources with a spatial index skip what lies outside the window; says how many features they skip.
std::uint64_t use_index(OGRLayer& layer, const Projection& projection, const VectorQuery& query) {
  if (!layer.TestCapability(OLCFastSpatialFilter) || !layer.TestCapability(OLCFastFeatureCount)) return 0;
  constexpr int kSide = 16;
  std::vector<double> x, y;
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) {
      const double s = -0.1 + 1.2 * i / kSide;
      const double t = -0.1 + 1.2 * j / kSide;
      x.push_back(query.south_west.longitude_deg +
                  s * (query.north_east.longitude_deg - query.south_west.longitude_deg));
      y.push_back(query.south_west.latitude_deg +
                  t * (query.north_east.latitude_deg - query.south_west.latitude_deg));
    }
  }
  projection.forward(x, y);
  const auto finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(x.begin(), x.end(), finite)) return 0;
  // A full turn of longitude more or less would be the same place to us, but not to the index.
  if (projection.turn() != 0 &&
      (query.south_west.longitude_deg < -170 || query.north_east.longitude_deg > 170))
    return 0;
  const GIntBig all = layer.GetFeatureCount();
  layer.SetSpatialFilterRect(*std::min_element(x.begin(), x.end()), *std::min_element(y.begin(), y.end()),
                             *std::max_element(x.begin(), x.end()), *std::max_element(y.begin(), y.end()));
  const GIntBig seen = layer.GetFeatureCount();
  return all > seen && seen >= 0 ? static_cast<std::uint64_t>(all - seen) : 0;
}

/// "key"=>"value" inside OGR's text form of further OpenStreetMap tags.
std::optional<std::string> other_tag(const std::string& tags, const std::string& key) {
  const std::string start = "\"" + key + "\"=>\"";
  const std::size_t at = tags.find(start);
  if (at == std::string::npos) return {};
  const std::size_t end = tags.find("\",\"", at + start.size());
  const std::size_t stop = end == std::string::npos ? tags.rfind('"') : end;
  if (stop < at + start.size()) return {};
  return tags.substr(at + start.size(), stop - at - start.size());
}

}  // namespace

std::optional<std::string> VectorFeature::text(const std::string& field) const {
  const int index = feature_.GetFieldIndex(field.c_str());
  if (index >= 0 && feature_.IsFieldSetAndNotNull(index)) return feature_.GetFieldAsString(index);
  const int tags = feature_.GetFieldIndex("other_tags");
  if (tags >= 0 && feature_.IsFieldSetAndNotNull(tags))
    return other_tag(feature_.GetFieldAsString(tags), field);
  return {};
}

std::int64_t VectorFeature::id() const { return feature_.GetFID(); }

VectorSummary visit_features(const VectorQuery& query,
                             const std::function<void(const VectorFeature&)>& visit) {
  VectorSummary summary;
  const Dataset dataset = opened(query);
  OGRLayer& layer = chosen_layer(*dataset, query);
  require_field(layer, query);
  summary.fields = field_names(layer);
  const Projection projection = projection_of(layer, query, summary.notes);
  GdalMessages messages;
  summary.skipped_by_index = use_index(layer, projection, query);
  messages.clear();
  std::vector<double> x, y;
  layer.ResetReading();
  while (const std::unique_ptr<OGRFeature> feature{layer.GetNextFeature()}) {
    VectorFeature visited(*feature);
    visited.polygons = polygons_of(*feature);
    to_lonlat(projection, visited.polygons, x, y);
    ++summary.visited;
    visit(visited);
  }
  if (!messages.failure().empty())
    refuse(query, "it cannot be read to its end: " + messages.failure(), "a whole, readable source");
  return summary;
}

}  // namespace obliq
