#include "server/radar/sweep/building_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/kernels.h"

namespace obliq {
namespace {

constexpr float kFarBelow = -1e9F;

/// A share of the ground's light below this is a sliver beside a building, no gap between two.
constexpr double kLeastLeft = 1.0 / 64;

float as_float(double x) { return static_cast<float>(x); }

}  // namespace

double lowest_slope_in_swath(const FramePlan& plan) {
  const double lowest_m = plan.scene().tiles().lowest_m() - plan.sector().antenna_m.y;
  if (lowest_m >= 0) return 0;
  const double r_min_m = plan.bins().r_min_m;
  if (r_min_m <= -lowest_m) return -HUGE_VAL;
  return lowest_m / std::sqrt((r_min_m - lowest_m) * (r_min_m + lowest_m));
}

BuildingView::BuildingView(const FramePlan& plan)
    : plan_(plan),
      planes_(sweep_columns_per_bin(plan.settings())),
      lowest_slope_(lowest_slope_in_swath(plan)) {
  const BinGrid& bins = plan.bins();
  const HeightGrid& grid = plan.scene().world().grid;
  const auto power_of_two = [](int n) {
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(16, n))));
  };
  least_n_ = power_of_two(planes_);
  most_n_ = std::max(least_n_, power_of_two(plan.settings().sub_columns));
  half_ = as_float(std::tan(bins.azimuth_width_rad / 2));

  // Half a cell apart, or half a bin: finer nodes change nothing that E shows.
  const double node_m = std::max(std::min(bins.range_spacing_m, grid.cell_m) / 2, bins.range_spacing_m / 16);
  NodeProfiles& nodes = columns_.nodes;
  nodes.planes = planes_;
  nodes.node_m = as_float(node_m);
  nodes.n_nodes = static_cast<int>(plan.building_reach_m() / node_m) + 8;
  nodes.stride = (nodes.n_nodes + 31) / 16 * 16;
  const std::size_t n = static_cast<std::size_t>(nodes.stride) * static_cast<std::size_t>(planes_);
  for (std::vector<float>* values : {&horizon_, &clearance_, &range_bin_, &hidden_}) values->resize(n);
  nodes.horizon = horizon_.data();
  nodes.clearance = clearance_.data();
  nodes.range_bin = range_bin_.data();
  nodes.hidden = hidden_.data();
  columns_.r_min_m = as_float(bins.r_min_m);
  columns_.range_spacing_m = as_float(bins.range_spacing_m);
  columns_.n_range = bins.n_range;
}

SinCos BuildingView::bearing(double position) const {
  const SinCos offset = sincos_turns(plan_.bins().azimuth_edge_rad(position) / (2 * std::numbers::pi));
  const glm::dvec3 d = plan_.sector().world_from_antenna(offset.sin, 0, offset.cos);
  return {d.x, d.z};
}

bool BuildingView::start(int azimuth_bin, int profile) {
  buildings_ = plan_.buildings_in(azimuth_bin);
  if (buildings_.empty()) return false;
  profile_ = profile;
  collected_ = seen_ = 0;
  of_parts_.clear();
  corners_.clear();
  parts_.clear();
  centre_ = bearing(azimuth_bin + 0.5);
  set_out(centre_);
  const double cells_per_m = 1 / plan_.scene().world().grid.cell_m;
  for (int plane = 0; plane < planes_; ++plane) {
    const SinCos along = bearing(azimuth_bin + (plane + 0.5) / planes_);
    widest_kernels().profile_nodes(columns_, plane, as_float(along.sin * cells_per_m),
                                   as_float(along.cos * cells_per_m));
  }
  return true;
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
  std::ranges::fill(hidden_, 0.0F);
  roofs_.assign(static_cast<std::size_t>(least_n_), kFarBelow);
  set_fineness(least_n_);
}

void BuildingView::set_fineness(int n) {
  columns_.n = n;
  columns_.log2_n = std::countr_zero(static_cast<unsigned>(n));
  columns_.left = -half_;
  columns_.width = 2 * half_ / static_cast<float>(n);
  columns_.width_rad = as_float(plan_.bins().azimuth_width_rad / n);
  columns_.roofs = roofs_.data();
  per_plane_.assign(static_cast<std::size_t>(planes_), 0);
  for (int k = 0; k < n; ++k) per_plane_[static_cast<std::size_t>(k * planes_ >> columns_.log2_n)] += 1;
  for (float& share : per_plane_) share = 1 / share;
  columns_.per_plane = per_plane_.data();
}

/// Halves the sub-columns as often as the distance asks for: all of them are there from half of r_max on,
/// half of them from a quarter on, and so forth.
void BuildingView::refine(float near_m) {
  int wanted = most_n_;
  double from_m = plan_.bins().r_max_m / 2;
  while (wanted > least_n_ && static_cast<double>(near_m) < from_m) {
    wanted /= 2;
    from_m /= 2;
  }
  while (columns_.n < wanted) {
    std::vector<float> finer;
    finer.reserve(roofs_.size() * 2);
    for (const float slope : roofs_) finer.insert(finer.end(), {slope, slope});
    roofs_ = std::move(finer);
    set_fineness(columns_.n * 2);
  }
}

void BuildingView::collect(std::uint32_t b) {
  const Buildings& all = plan_.scene().world().buildings;
  const Building& building = all.list[b];
  for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p)
    collect(b, p, std::span(all.part_xz_m).subspan(all.parts[p].first_corner, all.parts[p].n_corners));
  if (building.n_parts > 0) return;
  const std::uint32_t begin = all.ring_start[building.first_ring];
  collect(b, kWhole,
          std::span(all.ring_xz_m).subspan(begin, all.ring_start[building.first_ring + 1] - begin));
}

/// A part's corners in the bin's axes.
void BuildingView::collect(std::uint32_t b, std::uint32_t of, std::span<const glm::vec2> outline) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const auto first = static_cast<std::uint32_t>(corners_.size());
  float near_m = HUGE_VALF;
  float far_m = 0;
  float from = HUGE_VALF;
  float to = -HUGE_VALF;
  for (const glm::vec2& corner : outline) {
    const double dx = static_cast<double>(corner.x) - antenna.x;
    const double dz = static_cast<double>(corner.y) - antenna.z;
    const float right = as_float(dx * centre_.cos - dz * centre_.sin);
    const float ahead = as_float(dx * centre_.sin + dz * centre_.cos);
    const float tangent = right / ahead;
    near_m = std::min(near_m, ahead);
    far_m = std::max(far_m, ahead);
    from = std::min(from, tangent);
    to = std::max(to, tangent);
    corners_.push_back({right, ahead, tangent});
  }
  const double roof_m = static_cast<double>(plan_.scene().world().buildings.list[b].roof_y_m) - antenna.y;
  const double top_slope = roof_m / (1.001 * static_cast<double>(far_m));
  if (!(near_m > 0) || static_cast<double>(near_m) > plan_.building_reach_m() || !(to > -half_) ||
      !(from < half_) || (roof_m < 0 && top_slope < lowest_slope_)) {
    corners_.resize(first);
    return;
  }
  // The bits of positive floats are in the order of the floats.
  const std::uint64_t order = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(near_m)) << 32 |
                              static_cast<std::uint32_t>(parts_.size());
  parts_.push_back({order, b, of, first, static_cast<std::uint32_t>(outline.size()), from, to});
}

bool BuildingView::step(EchoCells& cells) {
  if (collected_ < buildings_.size()) {
    const std::size_t end = std::min(collected_ + kMostParts, buildings_.size());
    for (; collected_ < end; ++collected_) collect(buildings_[collected_]);
    if (collected_ == buildings_.size())
      std::ranges::sort(parts_, {}, [](const Part& part) { return part.order; });
    return true;
  }
  const std::size_t end = std::min(seen_ + kMostParts, parts_.size());
  for (; seen_ < end; ++seen_) see(parts_[seen_], cells);
  if (seen_ < parts_.size()) return true;
  add_parts_together(cells);
  return false;
}

void BuildingView::fill_shape(const Part& part) {
  const Buildings& all = plan_.scene().world().buildings;
  const Building& building = all.list[part.building];
  const Corner* const corner = corners_.data() + part.first;
  shape_.n = static_cast<int>(part.n);
  for (std::uint32_t k = 0; k <= part.n; ++k) {
    const Corner& c = corner[k < part.n ? k : 0];
    shape_.right_m[k] = c.right_m;
    shape_.ahead_m[k] = c.ahead_m;
    shape_.tangent[k] = c.tangent;
  }
  shape_.walls = ~std::uint64_t{0};
  if (part.of != kWhole)
    for (std::uint32_t k = 0; k < part.n; ++k)
      if (all.part_wall[all.parts[part.of].first_corner + k] == kNoFace)
        shape_.walls &= ~(std::uint64_t{1} << k);
  shape_.roof_m = building.roof_y_m - columns_.ground.antenna_y_m;
  shape_.base_m = building.base_y_m - columns_.ground.antenna_y_m;
}

void BuildingView::see(const Part& part, EchoCells& cells) {
  fill_shape(part);
  refine(std::bit_cast<float>(static_cast<std::uint32_t>(part.order >> 32)));
  const auto column_of = [&](float tangent) {
    const float at = (tangent + half_) / columns_.width;
    return static_cast<int>(std::clamp(at, 0.0F, static_cast<float>(columns_.n - 1)));
  };
  constexpr int kLanes = 16;
  const int from = column_of(part.from);
  const int lanes = (column_of(part.to) - from + kLanes) / kLanes * kLanes;
  int first = std::min(from, columns_.n - lanes);
  if (first < 0) first = 0;
  echoes_.n = 0;
  for (int k = first; k < std::min(first + lanes, columns_.n); k += kLanes)
    widest_kernels().see_part(columns_, shape_, k, echoes_);
  if (echoes_.n > 0) add_echoes(part, cells);
}

void BuildingView::add_echoes(const Part& part, EchoCells& cells) {
  const Buildings& all = plan_.scene().world().buildings;
  plan_.seen().mark(part.building);
  const std::uint32_t roof = all.list[part.building].first_face;
  // Sixteen sub-columns at a time: what several of them saw of a face in a bin is one echo.
  PartEchoes::Echo* const begin = echoes_.echo;
  PartEchoes::Echo* end = begin + echoes_.n;
  if (part.to - part.from > 16 * columns_.width) {
    std::sort(begin, end, [](const PartEchoes::Echo& p, const PartEchoes::Echo& q) {
      return p.edge != q.edge ? p.edge < q.edge : p.bin < q.bin;
    });
    PartEchoes::Echo* last = begin;
    for (PartEchoes::Echo* echo = begin + 1; echo < end; ++echo) {
      if (echo->edge == last->edge && echo->bin == last->bin) {
        last->solid_angle_sr += echo->solid_angle_sr;
        last->tangent_sr += echo->tangent_sr;
      } else {
        *++last = *echo;
      }
    }
    end = last + 1;
  }
  for (PartEchoes::Echo* echo = begin; echo < end; ++echo) {
    FaceEcho face = face_echo(*echo);
    if (part.of == kWhole) {
      face.face = roof + static_cast<std::uint32_t>(echo->edge + 1);
      cells.add(profile_, face);
    } else {
      face.face =
          echo->edge == PartEchoes::kRoof
              ? roof
              : all.part_wall[all.parts[part.of].first_corner + static_cast<std::uint32_t>(echo->edge)];
      of_parts_.push_back(face);
    }
  }
}

/// What an echo of the part in hand is, but for the face's number.
FaceEcho BuildingView::face_echo(const PartEchoes::Echo& echo) const {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  FaceEcho face{};
  face.range_bin = echo.bin;
  face.solid_angle_sr = static_cast<double>(echo.solid_angle_sr);
  face.range_m = static_cast<double>(echo.range_m);
  const double tangent = static_cast<double>(echo.tangent_sr) / face.solid_angle_sr;
  const double secant2 = 1 + tangent * tangent;
  const double range2 = face.range_m * face.range_m;
  const double roof_m = static_cast<double>(shape_.roof_m);
  double height_m = roof_m;
  double plane_distance_m = std::abs(roof_m);
  double ahead_m = std::sqrt(std::max(0.0, range2 - roof_m * roof_m) / secant2);
  if (echo.edge != PartEchoes::kRoof) {
    const auto e = static_cast<std::size_t>(echo.edge);
    const double right0 = static_cast<double>(shape_.right_m[e]);
    const double ahead0 = static_cast<double>(shape_.ahead_m[e]);
    const double dr = static_cast<double>(shape_.right_m[e + 1]) - right0;
    const double da = static_cast<double>(shape_.ahead_m[e + 1]) - ahead0;
    const double cross = ahead0 * dr - right0 * da;
    const double low = std::min(ahead0, ahead0 + da);
    ahead_m = std::clamp(cross / (dr - tangent * da), low, low + std::abs(da));
    plane_distance_m = cross / std::sqrt(dr * dr + da * da);
    const double up = std::sqrt(std::max(0.0, range2 - ahead_m * ahead_m * secant2));
    height_m = std::min(-up >= static_cast<double>(shape_.base_m) ? -up : up, roof_m);
  }
  const double middle = static_cast<double>(echo.middle_m);
  face.sec2_incidence = std::max(1.0, middle * middle / std::max(plane_distance_m * plane_distance_m, 1e-6));
  const double right_m = ahead_m * tangent;
  face.at_m = {antenna.x + ahead_m * centre_.sin + right_m * centre_.cos, antenna.y + height_m,
               antenna.z + ahead_m * centre_.cos - right_m * centre_.sin};
  return face;
}

/// A face that several parts of a building share is one scatterer.
void BuildingView::add_parts_together(EchoCells& cells) {
  std::ranges::stable_sort(of_parts_, [](const FaceEcho& p, const FaceEcho& q) {
    return p.face != q.face ? p.face < q.face : p.range_bin < q.range_bin;
  });
  for (std::size_t k = 0; k < of_parts_.size();) {
    FaceEcho sum = of_parts_[k];
    for (++k;
         k < of_parts_.size() && of_parts_[k].face == sum.face && of_parts_[k].range_bin == sum.range_bin;
         ++k)
      sum.solid_angle_sr += of_parts_[k].solid_angle_sr;
    cells.add(profile_, sum);
  }
}

void BuildingView::kept_shares(int plane, float* kept, EchoCells& cells) const {
  const NodeProfiles& nodes = columns_.nodes;
  const std::size_t first = static_cast<std::size_t>(plane) * static_cast<std::size_t>(nodes.stride);
  const float* const horizon = horizon_.data() + first;
  const float* const range_bin = range_bin_.data() + first;
  const float* const hidden = hidden_.data() + first;
  // What is visible and what of it is hidden up to the edges of range bins.
  const int n_range = columns_.n_range;
  double hidden_so_far = 0;
  double visible_before = static_cast<double>(horizon[0]);
  double hidden_before = 0;
  int edge = 0;
  for (int k = 0; k + 1 < nodes.n_nodes && edge <= n_range; ++k) {
    const double step = static_cast<double>(horizon[k + 1]) - static_cast<double>(horizon[k]);
    const double here = static_cast<double>(range_bin[k]);
    const double next = static_cast<double>(range_bin[k + 1]);
    for (; edge <= n_range && edge < next; ++edge) {
      const double part = next > here ? std::clamp((edge - here) / (next - here), 0.0, 1.0) : 0.0;
      const double visible = static_cast<double>(horizon[k]) + part * step;
      const double hidden_here = hidden_so_far + part * static_cast<double>(hidden[k]);
      if (edge > 0 && hidden_here > hidden_before) {
        const double left = 1 - (hidden_here - hidden_before) / (visible - visible_before);
        const bool none = !(left >= kLeastLeft);
        kept[static_cast<std::size_t>(edge - 1) * kWedgeAzimuthBins] =
            none ? 0 : as_float(std::min(1.0, left));
        if (none) cells.mark_building_shadow(profile_, edge - 1);
      }
      visible_before = visible;
      hidden_before = hidden_here;
    }
    hidden_so_far += static_cast<double>(hidden[k]);
  }
}

}  // namespace obliq
