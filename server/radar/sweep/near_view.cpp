#include "server/radar/sweep/near_view.h"

#include <algorithm>
#include <cmath>

#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

// In units of ask(): a strip, a building that it may cross, a sample.
constexpr int kAStrip = 20;
constexpr int kABuilding = 2;
constexpr int kASample = 20;
constexpr int kNodes = 8;  // that one unit hides ground at

/// Of a bin that has no corner in it: ground is as high all across a strip.
constexpr int kLeastStrips = 2;
/// As SegmentSampler::kMostTurn_rad, of a surface that shines alike at any incidence.
constexpr double kDullTurn_rad = 1.0 / 8;

/// Whether a lobe shines at an incidence: below exp(-15) of its peak there is less than 1e-3 of any floor.
bool shines(const EchoTable& table, std::uint8_t material, double cos_incidence) {
  constexpr double kDark = 15;
  const double tan2 = 1 / (cos_incidence * cos_incidence) - 1;
  return table.peak[material] > 0 && tan2 * table.over_two_slope2[material] < kDark;
}

/// The angle over which an echo is of one incidence and gain.
double turn_rad(const EchoTable& table, std::uint8_t material, double greatest_cos) {
  return table.elevation.gain != nullptr || shines(table, material, greatest_cos)
             ? SegmentSampler::kMostTurn_rad
             : kDullTurn_rad;
}

constexpr double kFarBelow = -1e9;
constexpr double kLeast_m = 1e-3;

/// One plane's nodes.
class PlaneNodes {
 public:
  PlaneNodes(const NodeProfiles& all, int plane) : n_(all.n_nodes), node_m_(static_cast<double>(all.node_m)) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(plane) * all.stride;
    horizon_ = all.horizon + first;
    clearance_ = all.clearance + first;
    hidden_ = all.hidden + first;
  }

  int node_at(double d_m) const { return static_cast<int>(std::clamp(d_m / node_m_, 0.0, n_ - 2.0)); }
  double horizon_at(double d_m) const { return at(horizon_, d_m); }
  double clearance_at(double d_m) const { return at(clearance_, d_m); }

  /// Takes a share of the slopes from `from` to `to` off the ground from a distance on.
  void hide(double from_m, float from, float to, float share) {
    const float* const end = horizon_ + n_;
    const float* node = std::upper_bound(horizon_ + node_at(from_m) + 1, end, from) - 1;
    const float* const last = std::lower_bound(node, end - 1, to);
    float* hidden = hidden_ + (node - horizon_);
    ask((last - node) / kNodes);
    for (; node < last; ++node) *hidden++ += (std::min(node[1], to) - std::max(node[0], from)) * share;
  }

 private:
  /// Heights are linear in distance between nodes, slopes are not; before the first they are as high as
  /// there.
  double at(const float* values, double d_m) const {
    const int k = node_at(d_m);
    const auto height_m = [&](int node) { return static_cast<double>(values[node]) * node * node_m_; };
    const double past = std::clamp(d_m / node_m_ - k, 0.0, 1.0);
    const double here_m = k == 0 ? height_m(1) : height_m(k);
    return (here_m + past * (height_m(k + 1) - here_m)) / std::max(d_m, kLeast_m);
  }

  int n_;
  double node_m_;
  const float* horizon_;
  const float* clearance_;
  float* hidden_;
};

}  // namespace

NearView::NearView(const ScenePlan& plan, const NearBuildings& buildings, const ScatteringTable& scattering,
                   double far_m)
    : plan_(plan), near_(buildings), scattering_(scattering), far_m_(far_m), sampler_(plan) {}

bool NearView::see(int azimuth_bin, int profile, const SubColumns& columns, CornerView& corners,
                   EchoCells& cells) {
  buildings_ = near_.in(azimuth_bin);
  if (buildings_.empty()) return false;
  cut(azimuth_bin, columns.nodes.planes);
  echoes_.clear();
  sampler_.begin(samples_);
  for (Strip& strip : strips_) {
    const double middle_rad = (strip.from_rad + strip.to_rad) / 2;
    const SinCos bearing = plan_.sector().world_bearing(middle_rad);
    find_spans(strip, bearing);
    if (spans_.empty()) continue;
    sampler_.set({azimuth_bin, middle_rad, strip.to_rad - strip.from_rad, bearing});
    march(strip, bearing, columns, plan_.bins().azimuth_edge_rad(azimuth_bin), corners, cells);
  }
  take_samples(cells);
  add_echoes(profile, cells);
  return true;
}

/// Divides the bin at the corners of its buildings.
void NearView::cut(int azimuth_bin, int planes) {
  const int n = std::max(planes, kLeastStrips);
  const double from_rad = plan_.bins().azimuth_edge_rad(azimuth_bin);
  const double to_rad = plan_.bins().azimuth_edge_rad(azimuth_bin + 1.0);
  edges_.clear();
  for (int k = 0; k <= n; ++k) edges_.push_back(from_rad + (to_rad - from_rad) * k / n);
  edges_.back() = to_rad;
  for (const NearBuildings::Seen& seen : buildings_)
    for (const double corner : near_.silhouette(seen).corners_rad)
      if (corner + seen.by_rad > from_rad && corner + seen.by_rad < to_rad)
        edges_.push_back(corner + seen.by_rad);
  ask(static_cast<std::int64_t>(edges_.size()));
  std::ranges::sort(edges_);
  strips_.clear();
  for (std::size_t k = 0; k + 1 < edges_.size(); ++k)
    if (edges_[k + 1] > edges_[k]) strips_.push_back({edges_[k], edges_[k + 1], kFarBelow});
}

/// What the strip's plane crosses of buildings that may show.
void NearView::find_spans(const Strip& strip, SinCos bearing) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double middle_rad = (strip.from_rad + strip.to_rad) / 2;
  spans_.clear();
  ask(kAStrip + kABuilding * static_cast<std::int64_t>(buildings_.size()));
  for (const NearBuildings::Seen& seen : buildings_) {
    const Silhouette& building = near_.silhouette(seen);
    const double bearing_rad = middle_rad - seen.by_rad;
    if (building.near_m > far_m_) break;
    if (!(building.from_rad <= bearing_rad && bearing_rad <= building.to_rad)) continue;
    const bool hidden = std::ranges::any_of(spans_, [&](const RoofSpan& span) {
      const double height_m = span.roof_y_m - antenna.y;
      return span.far_m <= building.near_m && span.near_m > 0 &&
             std::max(height_m / span.near_m, height_m / span.far_m) >= building.top_slope;
    });
    if (!hidden)
      add_roof_spans(plan_.scene().world().buildings, building.building, antenna.x, antenna.z, bearing.sin,
                     bearing.cos, spans_);
  }
}

/// Passes the strip's walls and roofs outwards, and takes what they hide off its plane's ground.
void NearView::march(Strip& strip, SinCos bearing, const SubColumns& columns, double start_rad,
                     CornerView& corners, const EchoCells& cells) {
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double width_rad = plan_.bins().azimuth_width_rad / columns.nodes.planes;
  const int plane =
      std::clamp(static_cast<int>(((strip.from_rad + strip.to_rad) / 2 - start_rad) / width_rad), 0,
                 columns.nodes.planes - 1);
  const auto share = static_cast<float>((strip.to_rad - strip.from_rad) / width_rad);
  PlaneNodes nodes(columns.nodes, plane);
  double touching_m = -1;  // where the last roof ends
  for (const RoofSpan& step : disjoint_roofs(spans_)) {
    if (step.near_m > far_m_) break;
    if (!(step.near_m < step.far_m)) continue;
    const Building& building = world.buildings.list[step.building];
    const double roof_m = step.roof_y_m - antenna.y;
    const double near_m = step.near_m;
    const double horizon = nodes.horizon_at(near_m);
    const double clearance = nodes.clearance_at(near_m);
    double foot = kFarBelow;
    double top = roof_m < 0 ? kFarBelow : -kFarBelow;
    if (near_m > 0) {
      const double ground_m =
          world.grid.height_at_m(antenna.x + near_m * bearing.sin, antenna.z + near_m * bearing.cos) -
          antenna.y;
      const double base_m = static_cast<double>(building.base_y_m) - antenna.y;
      foot = std::isnan(ground_m) ? std::max(base_m / near_m, horizon) : ground_m / near_m + clearance;
      top = roof_m / near_m;
    }
    const double low = std::max(foot, strip.slope);
    const double back = roof_m / step.far_m;
    if (near_m > 0 && step.wall != kNoFace && top > low) {
      const WallPlane wall = wall_plane(world.buildings, step.wall, antenna.x, antenna.z);
      const bool on_roof = near_m - touching_m < kTouching_m && strip.slope > foot;
      const auto stands = on_roof                               ? VisibleSegment::Foot::roof
                          : strip.slope > foot || clearance > 0 ? VisibleSegment::Foot::hidden
                                                                : VisibleSegment::Foot::ground;
      if (wall.distance_m > 0) {
        if (corners.wanted() && stands == VisibleSegment::Foot::ground) {
          // A strip's ends may reach a little beyond the wall's.
          const auto distance_m = [&](double off_rad) {
            const double slope = wall.normal_x * (bearing.sin + off_rad * bearing.cos) +
                                 wall.normal_z * (bearing.cos - off_rad * bearing.sin);
            return std::clamp(-wall.distance_m / slope, wall.nearest_m, wall.farthest_m);
          };
          const double half_rad = (strip.to_rad - strip.from_rad) / 2;
          if (corners.begin({step.building, step.wall, building.material, wall.normal_x, wall.normal_z,
                             bearing, 2 * half_rad, near_m, foot * near_m, roof_m, plane},
                            columns.nodes)) {
            corners.spread(distance_m(-half_rad), distance_m(half_rad));
            corners.light(0, 1, strip.slope);
          }
        }
        sampler_.set_turn(turn_rad(cells.table(), building.material, wall.distance_m / near_m));
        sampler_.visible({near_m, 0, 0, 1, low * near_m, roof_m, wall.distance_m, step.wall,
                          building.material, false, 0, 0, true, wall.normal_x, wall.normal_z, wall.nearest_m,
                          wall.farthest_m, stands});
      }
    }
    touching_m = step.far_m;
    if (const double from = std::max(low, top); roof_m < 0 && back > from) {
      const double from_m = std::max(near_m, roof_m / from);
      if (from_m < step.far_m) {
        sampler_.set_turn(turn_rad(cells.table(), building.material, -roof_m / std::hypot(from_m, roof_m)));
        sampler_.visible({0, roof_m, 1, 0, from_m, step.far_m, -roof_m, building.first_face,
                          building.material, false, 0, 0, false, 0, 0, 0, 0, VisibleSegment::Foot::hidden});
      }
    }
    const double highest = std::max(top, back);
    if (highest > low) {
      // It hides its plane's ground as if it stood there as it stands on its own.
      const double shift = near_m > 0 ? horizon - foot : 0;
      nodes.hide(near_m, static_cast<float>(low + shift), static_cast<float>(highest + shift), share);
      strip.slope = std::max(strip.slope, highest);
    }
    if (sampler_.full()) take_samples(cells);
  }
}

/// From samples to powers.
void NearView::take_samples(const EchoCells& cells) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  do {
    ask(kASample * samples_.n);
    for (int s = 0; s < samples_.n; ++s) {
      const auto k = static_cast<std::size_t>(s);
      const double range_m = samples_.slant_range_m[k];
      const int bin = plan_.bins().range_bin(range_m);
      if (bin < 0 || range_m < kNearest_m) continue;
      const std::uint32_t face = samples_.face[k];
      FacePower echo{
          bin, plan_.scene().world().buildings.building_of_face[face], face, samples_.material[k], 0, range_m,
          {}};
      echo.at_m = {samples_.x_m[k], antenna.y + range_m * samples_.sin_elevation[k], samples_.z_m[k]};
      const double area_m2 = samples_.solid_angle_sr[k] * range_m * range_m;
      const double cosine = samples_.cos_incidence[k];
      echo.power = cells.power_of(shines(cells.table(), echo.material, cosine)
                                      ? scattering_.cross_section_m2(echo.material, area_m2, cosine)
                                      : cells.table().gamma[echo.material] * area_m2,
                                  range_m, echo.at_m);
      echo.range_m *= echo.power;
      echo.at_m *= echo.power;
      if (!echoes_.empty() && echoes_.back().face == echo.face && echoes_.back().range_bin == bin) {
        echoes_.back().add(echo);
        continue;
      }
      echoes_.push_back(echo);
      plan_.seen().mark(echo.building);
    }
    sampler_.begin(samples_);
  } while (samples_.n > 0);
}

/// What the strips see of a face in a range bin is one scatterer.
void NearView::add_echoes(int profile, EchoCells& cells) {
  std::ranges::stable_sort(echoes_, [](const FacePower& p, const FacePower& q) {
    ask(2);
    return p.face != q.face ? p.face < q.face : p.range_bin < q.range_bin;
  });
  for (std::size_t k = 0; k < echoes_.size();) {
    FacePower sum = echoes_[k];
    for (++k; k < echoes_.size() && echoes_[k].face == sum.face && echoes_[k].range_bin == sum.range_bin; ++k)
      sum.add(echoes_[k]);
    cells.add(profile, sum);
  }
}

float NearView::roof_slope(double offset_rad) const {
  const auto strip = std::ranges::find_if(strips_, [&](const Strip& s) { return s.to_rad > offset_rad; });
  return strip == strips_.end() ? static_cast<float>(kFarBelow) : static_cast<float>(strip->slope);
}

}  // namespace obliq
