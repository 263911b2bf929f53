#include "server/radar/profile/profile_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/line_of_sight.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kRun = 4096;           // rays between two times that are asked
constexpr std::int64_t kARoof = 10;  // its spans on a profile, in units of ask()

/// Answers the rays of one profile, those from `next` on, from what is visible.
struct AnswerVisible {
  const RayRows& rows;
  int nx;
  std::uint64_t& next;
  double* slant_range_m;
  std::uint32_t* surface;

  void visible(const VisibleSegment& segment) {
    const double low_d = segment.ground_range_m(segment.t0), low_h = segment.height_m(segment.t0);
    const double high_d = segment.ground_range_m(segment.t1), high_h = segment.height_m(segment.t1);
    for (; rows.slope[next] * high_d < high_h; ++next) {
      const double slope = rows.slope[next];
      if (slope * low_d < low_h) {
        slant_range_m[next] = 0;
        surface[next] = ProfileRays::kUnder;
        continue;
      }
      const double t =
          std::clamp((slope * segment.d_m - segment.h_m) / (segment.rate_h - slope * segment.rate_d),
                     segment.t0, segment.t1);
      slant_range_m[next] = segment.ground_range_m(t) * rows.secant[next];
      surface[next] = segment.face != kNoFace ? ProfileRays::kFace + segment.face
                                              : 2 * static_cast<std::uint32_t>(segment.j * nx + segment.i) +
                                                    (segment.upper ? 1 : 0);
    }
  }
  bool full() const { return next == rows.n; }
};

}  // namespace

/// Of one profile.
struct ProfileRays::Roofs {
  std::vector<RoofSpan> spans;
  SinCos bearing;
};

ProfileRays::ProfileRays(const Scene& scene, const glm::dvec3& antenna_m, std::span<const SinCos> elevation,
                         double reach_m, const Kernels& kernels)
    : world_(scene.world()),
      antenna_m_(antenna_m),
      ground_(ground_view(scene.world().grid, antenna_m)),
      kernels_(kernels),
      top_m_(scene.highest_m() - antenna_m.y),
      reach_m_(reach_m) {
  const HeightGrid& grid = world_.grid;
  const auto farther = [](double at, double first, double last) { return std::max(at - first, last - at); };
  reach_m_ = std::min(reach_m_, std::hypot(farther(antenna_m.x, grid.x0_m, grid.x1_m()),
                                           farther(antenna_m.z, grid.z0_m, grid.z1_m())));
  if (static_cast<std::uint64_t>(grid.nx) * static_cast<std::uint64_t>(grid.nz) >= kFace / 2)
    throw std::length_error("ProfileRays: the grid has 2^30 posts or more");
  for (const SinCos at : elevation) {
    if (slope_.size() % kRun == 0) ask(2 * kRun);
    slope_.push_back(at.sin / at.cos);
    secant_.push_back(1 / at.cos);
  }
  slope_.push_back(kInfinity);
  secant_.push_back(0);
}

/// The ground distance before which nothing reaches up to a ray. What stands no higher than top_m_ has slopes
/// of at most top_m_ / d. A little less, for flat ground.
double ProfileRays::start_m(std::size_t ray) const {
  if (!(top_m_ < 0 && slope_[ray] < 0)) return 0;
  return 0.999 * std::min(reach_m_, top_m_ / slope_[ray]);
}

void ProfileRays::answer(std::span<const SinCos> bearings, std::span<const std::uint32_t> buildings, Run run,
                         std::span<double> slant_range_m, std::span<std::uint32_t> surface) const {
  RayProfiles lanes{};
  lanes.slant_range_m = slant_range_m.data();
  lanes.surface = surface.data();
  std::array<Roofs, kMostProfiles> roofs;
  const double from_m = start_m(run.first);
  for (std::size_t k = 0; k < static_cast<std::size_t>(kMostProfiles); ++k) {
    lanes.end_m[k] = -1;
    lanes.roof_m[k] = kInfinity;
    if (k >= bearings.size()) continue;
    const SinCos bearing = roofs[k].bearing = bearings[k];
    const GroundWalk walk(world_.grid, antenna_m_, bearing.sin, bearing.cos, from_m, reach_m_);
    if (walk.done()) continue;
    set_out(lanes, k, bearing, walk);
    ask(kARoof * static_cast<std::int64_t>(buildings.size()));
    for (const std::uint32_t b : buildings)
      add_roof_spans(world_.buildings, b, antenna_m_.x, antenna_m_.z, bearing.sin, bearing.cos,
                     roofs[k].spans);
    for (const RoofSpan& span : roofs[k].spans)
      if (span.far_m > lanes.d_m[k]) lanes.roof_m[k] = std::min(lanes.roof_m[k], span.near_m);
  }
  const auto first = slope_.begin() + static_cast<std::ptrdiff_t>(run.first);
  std::vector<double> cut;
  if (run.first + run.count < rays()) {
    cut.assign(first, first + static_cast<std::ptrdiff_t>(run.count));
    cut.push_back(kInfinity);
  }
  const RayRows rows{cut.empty() ? &*first : cut.data(), secant_.data() + run.first, run.count};
  MarchedCells marched(lanes, world_.grid);
  while (const unsigned at_roof = kernels_.first_hits_in_profiles(ground_, rows, lanes)) {
    for (std::size_t k = 0; k < bearings.size(); ++k)
      if ((at_roof >> k & 1) != 0) pass_roofs(k, roofs[k], rows, run.first, lanes);
    marched.ask_for_them();
  }
  marched.ask_for_them();
  ask(static_cast<std::int64_t>(bearings.size() * run.count));
  for (std::size_t k = 0; k < bearings.size(); ++k) {
    const auto unanswered = static_cast<std::ptrdiff_t>(k * run.count + lanes.next[k]);
    const auto end = static_cast<std::ptrdiff_t>((k + 1) * run.count);
    std::fill(slant_range_m.begin() + unanswered, slant_range_m.begin() + end, 0.0);
    std::fill(surface.begin() + unanswered, surface.begin() + end, kNothing);
  }
}

/// Takes one profile past the roofs that it stands before.
void ProfileRays::pass_roofs(std::size_t k, Roofs& roofs, const RayRows& rows, std::size_t first_ray,
                             RayProfiles& lanes) const {
  // All that is nearer lies below the next ray.
  Horizon<double> horizon;
  const std::size_t next = first_ray + lanes.next[k];
  if (next > 0) horizon = {1, slope_[next - 1], false};
  LineOfSight profile(world_, antenna_m_, roofs.bearing, lanes.d_m[k], reach_m_, horizon, roofs.spans);
  AnswerVisible answers{rows, world_.grid.nx, lanes.next[k], lanes.slant_range_m + k * rows.n,
                        lanes.surface + k * rows.n};
  const RoofSpan* roof = profile.next_roof();
  while (roof && roof->near_m <= std::max(profile.at_m(), lanes.roof_m[k])) {
    profile.advance(std::min(roof->far_m, reach_m_), answers);
    const bool ended = answers.full() || profile.done() || profile.at_m() >= lanes.end_m[k];
    roof = ended ? nullptr : profile.next_roof();
  }
  stand_at(lanes, k, profile);
  lanes.roof_m[k] = roof ? roof->near_m : kInfinity;
}

}  // namespace obliq
