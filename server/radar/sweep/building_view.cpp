#include "server/radar/sweep/building_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "server/radar/simd/kernels.h"
#include "server/radar/sweep/sort_keys.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr float kFarBelow = -1e9F;

constexpr int kLanes = SubColumns::kLeastLanes;

// In units of ask(): to collect a building, and to see a corner of a part in sixteen sub-columns.
constexpr int kABuilding = 20;
constexpr int kAPart = 8;

/// Of a sub-column, as far as there may be so many.
constexpr double kWidest_m = 1.5;

/// Prefetch distance in buildings.
constexpr std::size_t kAskAhead = 16;

/// Buildings with sub-columns stand farther off than twice this (NearBuildings).
constexpr float kClip_m = 50;

float as_float(double x) { return static_cast<float>(x); }

/// No slope of a roof this high above the antenna is greater, as floats see it; `half`: tangent of half the
/// bin.
float highest_slope(float roof_m, float near_m, float far_m, float half) {
  constexpr float kRounding = 1e-4F;
  return roof_m > 0 ? roof_m / near_m * (1 + kRounding) : roof_m / far_m * (1 - kRounding - half * half);
}

int whole_registers(int lanes) { return (std::max(1, lanes) + kLanes - 1) / kLanes * kLanes; }

}  // namespace

BuildingView::BuildingView(const ScenePlan& plan, const NearBuildings& near,
                           const ScatteringTable& scattering, double far_m)
    : plan_(plan),
      near_(near),
      corner_view_(plan, scattering.corners()),
      near_view_(plan, near, scattering, far_m),
      far_m_(far_m),
      planes_(sweep_columns_per_bin(plan.settings())),
      lowest_slope_(lowest_slope_in_swath(plan)) {
  const BinGrid& bins = plan.bins();
  const HeightGrid& grid = plan.scene().world().grid;
  least_n_ = whole_registers(planes_);
  most_n_ = std::max(least_n_, whole_registers(plan.settings().sub_columns));
  half_ = as_float(std::tan(bins.azimuth_width_rad / 2));

  // Half a cell apart, or half a bin: finer nodes change nothing that E shows but near the antenna.
  const double parts = near.empty() ? 2 : 8;
  const double node_m =
      std::max(std::min(bins.range_spacing_m, grid.cell_m) / parts, bins.range_spacing_m / kMostNodesABin);
  NodeProfiles& nodes = columns_.nodes;
  nodes.planes = planes_;
  nodes.node_m = as_float(node_m);
  nodes.n_nodes = static_cast<int>(far_m_ / node_m) + 8;
  nodes.stride = (nodes.n_nodes + 31) / 16 * 16;
  const std::size_t n = static_cast<std::size_t>(nodes.stride) * static_cast<std::size_t>(planes_);
  for (std::vector<float>* values : {&horizon_, &clearance_, &range_bin_, &hidden_}) fill(*values, n, 0);
  if (!near.empty()) fill(sine_, n, 0);
  nodes.sine = near.empty() ? nullptr : sine_.data();
  nodes.horizon = horizon_.data();
  nodes.clearance = clearance_.data();
  nodes.range_bin = range_bin_.data();
  nodes.hidden = hidden_.data();
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  visible_up_to_.resize(n_range + 1 + LightLeft::kSpare);
  hidden_up_to_.resize(n_range + 1 + LightLeft::kSpare);
  left_.resize(n_range + LightLeft::kSpare);
  columns_.r_min_m = as_float(bins.r_min_m);
  columns_.range_spacing_m = as_float(bins.range_spacing_m);
  columns_.n_range = bins.n_range;
}

SinCos BuildingView::bearing(double position) const {
  return plan_.sector().world_bearing(plan_.bins().azimuth_edge_rad(position));
}

/// Prefetches the next buildings in two steps: header first, then outline. Inlined,
/// since a compiler leaves out calls of a function that only prefetches.
[[gnu::always_inline]] inline void BuildingView::ask_for_buildings(std::size_t from) const {
  const Buildings& all = plan_.scene().world().buildings;
  if (from + 2 * kAskAhead < buildings_.size())
    __builtin_prefetch(&all.list[buildings_[from + 2 * kAskAhead]]);
  if (from + kAskAhead < buildings_.size())
    __builtin_prefetch(&all.ring_xz_m[all.first_corner(buildings_[from + kAskAhead])]);
}

/// The same for the faces of the next parts.
[[gnu::always_inline]] inline void BuildingView::ask_for_faces(std::size_t from) const {
  if (from + 2 * kAskAhead < parts_.size()) __builtin_prefetch(&by_distance(from + 2 * kAskAhead));
  if (from + kAskAhead >= parts_.size()) return;
  const Buildings& all = plan_.scene().world().buildings;
  const Part& part = by_distance(from + kAskAhead);
  __builtin_prefetch(&all.list[part.building]);
  plan_.seen().ask_for(part.building);
  // first_corner() of the building, whose record need not be there yet.
  __builtin_prefetch(&all.ring_xz_m[part.roof_face - part.building]);
}

bool BuildingView::see(int azimuth_bin, int profile, EchoCells& cells) {
  buildings_ = plan_.buildings_in(azimuth_bin);
  if (buildings_.empty()) return false;
  start(azimuth_bin, profile);
  see_near(azimuth_bin, cells);
  for (std::size_t k = 0; k < buildings_.size(); ++k) {
    ask(kABuilding);
    ask_for_buildings(k);
    if (!near_.has(buildings_[k])) collect(buildings_[k]);
  }
  sort_keys(order_);
  // A shape is read in other pieces than it is written: it is written well before.
  if (!parts_.empty()) fill_shape(by_distance(0), shapes_[0]);
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    ask_for_faces(k);
    if (k + 1 < parts_.size()) fill_shape(by_distance(k + 1), shapes_[(k + 1) % 2]);
    see(by_distance(k), shapes_[k % 2], cells);
  }
  put_faces(cells);
  add_parts_together(cells);
  corner_view_.put(profile, cells);
  return true;
}

/// Those behind the near ones see what these hide in the middle of each sub-column.
void BuildingView::see_near(int azimuth_bin, EchoCells& cells) {
  if (!near_view_.see(azimuth_bin, profile_, columns_, corner_view_, cells)) return;
  const double from_rad = plan_.bins().azimuth_edge_rad(azimuth_bin);
  for (int k = 0; k < columns_.n; ++k)
    roofs_[static_cast<std::size_t>(k)] =
        near_view_.roof_slope(from_rad + plan_.bins().azimuth_width_rad * (k + 0.5) / columns_.n);
  if (corner_view_.wanted()) shades_.assign(roofs_.begin(), roofs_.end());
}

void BuildingView::kept_shares(int plane, float* kept, EchoCells& cells) {
  ask(columns_.nodes.n_nodes);
  LightLeft light{visible_up_to_.data(), hidden_up_to_.data(), left_.data(), 0, 0};
  active_kernels().light_left(columns_.nodes, plane, columns_.n_range, light);
  for (int bin = light.from; bin < light.to; ++bin) {
    const float left = left_[static_cast<std::size_t>(bin)];
    kept[static_cast<std::size_t>(bin) * kWedgeAzimuthBins] = left;
    cells.mark_building_shadow(profile_, bin, !(left > 0));
  }
}

/// Begins with another azimuth bin.
void BuildingView::start(int azimuth_bin, int profile) {
  profile_ = profile;
  of_parts_.clear();
  pieces_.n = 0;
  corners_.clear();
  parts_.clear();
  order_.clear();
  centre_ = bearing(azimuth_bin + 0.5);
  set_out(centre_);
  const double cells_per_m = 1 / plan_.scene().world().grid.cell_m;
  for (int plane = 0; plane < planes_; ++plane) {
    ask(4 * columns_.nodes.n_nodes);
    const SinCos along = bearing(azimuth_bin + (plane + 0.5) / planes_);
    active_kernels().profile_nodes(columns_, plane, as_float(along.sin * cells_per_m),
                                   as_float(along.cos * cells_per_m));
  }
}

/// Stands at the antenna, with the coarsest sub-columns and nothing hidden.
void BuildingView::set_out(SinCos centre) {
  const HeightGrid& grid = plan_.scene().world().grid;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  columns_.ground = {grid.y_m.data(),
                     grid.nx,
                     grid.nz,
                     as_float(antenna.y),
                     as_float((antenna.x - grid.x0_m) / grid.cell_m),
                     as_float((antenna.z - grid.z0_m) / grid.cell_m),
                     as_float(centre.sin / grid.cell_m),
                     as_float(centre.cos / grid.cell_m),
                     as_float(centre.cos / grid.cell_m),
                     as_float(-centre.sin / grid.cell_m)};
  fill(hidden_, hidden_.size(), 0);
  roofs_.assign(static_cast<std::size_t>(least_n_), kFarBelow);
  if (corner_view_.wanted()) shades_ = roofs_;
  set_fineness(least_n_);
}

void BuildingView::set_fineness(int n) {
  columns_.n = n;
  columns_.left = -half_;
  columns_.width = 2 * half_ / static_cast<float>(n);
  columns_.width_rad = as_float(plan_.bins().azimuth_width_rad / n);
  columns_.roofs = roofs_.data();
  columns_.shades = shades_.empty() ? nullptr : shades_.data();
  per_plane_.assign(static_cast<std::size_t>(planes_), 0);
  for (int k = 0; k < n; ++k) per_plane_[static_cast<std::size_t>(plane_of(k, planes_, n))] += 1;
  for (float& share : per_plane_) share = 1 / share;
  columns_.per_plane = per_plane_.data();
}

/// Makes sub-columns no wider than kWidest_m, as far as there may be so many. By distance alone: what is
/// nearer must not depend on where the swath ends.
void BuildingView::refine(float near_m) {
  const double width_m = static_cast<double>(near_m) * plan_.bins().azimuth_width_rad;
  if (columns_.n >= most_n_ || width_m <= kWidest_m * columns_.n) return;
  const int n = std::min(most_n_, whole_registers(static_cast<int>(std::ceil(width_m / kWidest_m))));
  for (std::vector<float>* slopes : {&roofs_, &shades_}) {
    if (slopes->empty()) continue;
    coarser_.assign(slopes->begin(), slopes->end());
    slopes->resize(static_cast<std::size_t>(n));
    // What hides the middle of the new one.
    for (int k = 0; k < n; ++k)
      (*slopes)[static_cast<std::size_t>(k)] =
          coarser_[static_cast<std::size_t>((2 * k + 1) * columns_.n / (2 * n))];
  }
  set_fineness(n);
}

void BuildingView::collect(std::uint32_t b) {
  const Buildings& all = plan_.scene().world().buildings;
  const Building& building = all.list[b];
  for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p) {
    const ConvexPart& part = all.parts[p];
    const std::size_t first = corners_.size();
    for (std::uint32_t k = part.first_corner; k < part.first_corner + part.n_corners; ++k)
      add_corner(all.part_xz_m[k], all.part_wall[k]);
    add_part(b, true, first);
  }
  if (building.n_parts > 0) return;
  const std::size_t first = corners_.size();
  const std::uint32_t first_corner = all.first_corner(b);
  const std::uint32_t first_wall = building.first_face + 1;  // the roof comes first
  for (std::uint32_t k = 0; k + 1 < building.n_faces; ++k)
    add_corner(all.ring_xz_m[first_corner + k], first_wall + k);
  add_part(b, false, first);
}

void BuildingView::add_corner(const glm::vec2& corner, std::uint32_t face) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double dx = static_cast<double>(corner.x) - antenna.x;
  const double dz = static_cast<double>(corner.y) - antenna.z;
  const float right = as_float(dx * centre_.cos - dz * centre_.sin);
  const float ahead = as_float(dx * centre_.sin + dz * centre_.cos);
  corners_.push_back({right, ahead, right / ahead, face});
}

/// Adds the corners from `first` on as a part, or discards it if it cannot affect the bin.
void BuildingView::add_part(std::uint32_t building, bool one_of_several, std::size_t first) {
  const auto by_ahead = [](const Corner& p, const Corner& q) { return p.ahead_m < q.ahead_m; };
  const auto begin = corners_.begin() + static_cast<std::ptrdiff_t>(first);
  if (std::min_element(begin, corners_.end(), by_ahead)->ahead_m < kClip_m) clip(first);
  float near_m = HUGE_VALF;
  float far_m = 0;
  float from = HUGE_VALF;
  float to = -HUGE_VALF;
  for (std::size_t k = first; k < corners_.size(); ++k) {
    near_m = std::min(near_m, corners_[k].ahead_m);
    far_m = std::max(far_m, corners_[k].ahead_m);
    from = std::min(from, corners_[k].tangent);
    to = std::max(to, corners_[k].tangent);
  }
  const Building& of = plan_.scene().world().buildings.list[building];
  const float antenna_y_m = columns_.ground.antenna_y_m;
  const float roof_m = of.roof_y_m - antenna_y_m;
  const float highest = highest_slope(roof_m, near_m, far_m, half_);
  const std::size_t n = corners_.size() - first;
  if (n < 3 || static_cast<double>(near_m) > far_m_ || !(to > -half_) || !(from < half_) ||
      static_cast<double>(highest) < lowest_slope_) {
    corners_.resize(first);
    return;
  }
  // The bits of positive floats are in the order of the floats.
  order_.push_back(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(near_m)) << 32 |
                   static_cast<std::uint32_t>(parts_.size()));
  parts_.push_back({near_m, building, of.first_face, roof_m, of.base_y_m - antenna_y_m, highest, of.material,
                    one_of_several, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(n), from,
                    to});
}

/// Clips a part to what lies ahead of the antenna: the rest is in none of the bin's directions.
void BuildingView::clip(std::size_t first) {
  clipped_.assign(corners_.begin() + static_cast<std::ptrdiff_t>(first), corners_.end());
  corners_.resize(first);
  const std::size_t n = clipped_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Corner& a = clipped_[k];
    const Corner& b = clipped_[(k + 1) % n];
    const bool a_in = a.ahead_m >= kClip_m;
    const bool b_in = b.ahead_m >= kClip_m;
    if (a_in) corners_.push_back(a);
    if (a_in == b_in) continue;
    const float part = (kClip_m - a.ahead_m) / (b.ahead_m - a.ahead_m);
    const float right = a.right_m + part * (b.right_m - a.right_m);
    corners_.push_back({right, kClip_m, right / kClip_m, a_in ? kNoFace : a.face});
  }
}

void BuildingView::fill_shape(const Part& part, ConvexShape& shape) const {
  const Corner* const corner = corners_.data() + part.first;
  shape.n = static_cast<int>(part.n);
  for (std::uint32_t k = 0; k <= part.n; ++k) {
    const Corner& c = corner[k < part.n ? k : 0];
    shape.right_m[k] = c.right_m;
    shape.ahead_m[k] = c.ahead_m;
    shape.tangent[k] = c.tangent;
  }
  shape.walls = 0;
  for (std::uint32_t k = 0; k < part.n; ++k)
    if (corner[k].face != kNoFace) shape.walls |= std::uint64_t{1} << k;
  shape.roof_m = part.roof_m;
  shape.base_m = part.base_m;
}

void BuildingView::see(const Part& part, const ConvexShape& shape, EchoCells& cells) {
  refine(part.near_m);
  const auto column_of = [&](float tangent) {
    const float at = (tangent + half_) / columns_.width;
    return static_cast<int>(std::clamp(at, 0.0F, static_cast<float>(columns_.n - 1)));
  };
  const int from = column_of(part.from);
  const int end = column_of(part.to) + 1;
  const int lanes = whole_registers(end - from);
  ask(kAPart * lanes / kLanes * static_cast<std::int64_t>(part.n));
  const int first = std::min(from, columns_.n - lanes);
  echoes_.n = 0;
  if (corner_view_.wanted()) see_corners(part, shape);
  const auto roof = roofs_.begin();
  if (std::all_of(roof + from, roof + end, [&](float slope) { return slope > part.highest; })) return;
  constexpr int kMost = SubColumns::kMostLanes;
  for (int k = first; k < first + lanes; k += kMost)
    active_kernels().see_part(columns_, shape, k, std::min(kMost, end - k), echoes_);
  if (lanes > kMost) join_echoes();
  if (echoes_.n > 0) add_echoes(part, shape, cells);
}

}  // namespace obliq
