#pragma once
// Polygons from any source that OGR can open, in longitude and latitude.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/world_spec.h"

class OGRFeature;

namespace obliq {

/// A polygon as read: rings of longitude and latitude in degrees, open (the last point is not the first
/// again). The first ring is the outline. Nothing is promised about order, crossings or finiteness.
struct GeoPolygon {
  std::vector<std::vector<LonLat>> rings;
};

/// One feature while it is visited.
class VectorFeature {
 public:
  explicit VectorFeature(OGRFeature& feature) : feature_(feature) {}

  std::vector<GeoPolygon> polygons;  ///< none when the feature has no area geometry

  /// A field as text, or a tag inside an OpenStreetMap "other_tags" field; nothing when it is absent or null.
  std::optional<std::string> text(const std::string& field) const;

  /// The source's own number of it.
  std::int64_t id() const;

 private:
  OGRFeature& feature_;
};

struct VectorQuery {
  std::string path;
  std::string layer;  ///< empty: the first
  std::string where;  ///< attribute filter; empty: all
  std::string key;    ///< configuration key of the path, for messages
  /// Corners of the wanted window in degrees. Sources with a spatial index skip what lies outside.
  LonLat south_west;
  LonLat north_east;
  std::string field{};  ///< that the layer has to have; empty: none
};

struct VectorSummary {
  std::uint64_t visited = 0;
  std::uint64_t skipped_by_index = 0;  ///< outside the window, never read
  std::string fields;                  ///< the layer's, as a list to be read
  std::vector<std::string> notes;
};

/// Visits every feature in the source's order. Polygons, multipolygons, collections, curves (as chords) and
/// closed lines count as polygons. Throws InputError that names the key, the file and what is wrong.
VectorSummary visit_features(const VectorQuery& query,
                             const std::function<void(const VectorFeature&)>& visit);

}  // namespace obliq
