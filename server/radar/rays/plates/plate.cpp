#include "server/radar/rays/plates/plate.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/ground/range_run.h"

namespace obliq {
namespace {

/// The bin of a range, -1 and n_range for those before and behind the swath.
int bin_or_outside(const BinGrid& bins, double r_m) {
  if (r_m < bins.r_min_m) return -1;
  if (r_m >= bins.r_max_m) return bins.n_range;
  return bins.range_bin(r_m);
}

}  // namespace

Plate::End Plate::end_at(const BinGrid& bins, double d_m, double h_m) const {
  if (d_m == end_.d_m && h_m == end_.h_m) return end_;
  const double r = std::sqrt(d_m * d_m + h_m * h_m);
  return {d_m, h_m, r, h_m / r, bin_or_outside(bins, r)};
}

void Plate::add(const BinGrid& bins, const SurfaceSegment& segment) {
  const double dd = segment.far_d_m - segment.near_d_m;
  const double dh = segment.far_h_m - segment.near_h_m;
  const double along = -(segment.near_d_m * dd + segment.near_h_m * dh);
  const double length2 = dd * dd + dh * dh;
  const End from = end_at(bins, segment.near_d_m, segment.near_h_m);
  const End to = end_at(bins, segment.far_d_m, segment.far_h_m);
  if (!(from.range_m > 0 && to.range_m > 0)) return;
  if (along > 0 && along < length2) {
    const double t = along / length2;
    const End foot = end_at(bins, segment.near_d_m + t * dd, segment.near_h_m + t * dh);
    if (!(foot.range_m > 0)) return;
    add_monotone(bins, segment, from, foot);
    add_monotone(bins, segment, foot, to);
  } else {
    add_monotone(bins, segment, from, to);
  }
  end_ = to;
}

void Plate::add_monotone(const BinGrid& bins, const SurfaceSegment& segment, const End& from, const End& to) {
  End last = from;
  if (from.bin != to.bin) {
    // Where |A + t D| = R: t = foot +- sqrt(R^2 - |A|^2 + foot^2 |D|^2) / |D|.
    const double dd = to.d_m - from.d_m;
    const double dh = to.h_m - from.h_m;
    const double over_length2 = 1 / (dd * dd + dh * dh);
    const double foot = -(from.d_m * dd + from.h_m * dh) * over_length2;
    const double nearest2 = from.range_m * from.range_m * over_length2 - foot * foot;
    const int step = to.bin > from.bin ? 1 : -1;
    for (int bin = from.bin; bin != to.bin; bin += step) {
      const double edge_m = bins.r_min_m + (step > 0 ? bin + 1 : bin) * bins.range_spacing_m;
      const double root = std::sqrt(std::max(0.0, edge_m * edge_m * over_length2 - nearest2));
      const double t = std::clamp(foot + step * root, 0.0, 1.0);
      const double h_cut = from.h_m + t * dh;
      const End cut{from.d_m + t * dd, h_cut, edge_m, h_cut / edge_m, bin};
      add_part(bin, segment, last, cut);
      last = cut;
    }
  }
  add_part(to.bin, segment, last, to);
}

void Plate::add_part(int bin, const SurfaceSegment& segment, const End& from, const End& to) {
  const double share = to.sine - from.sine;
  if (!(share > 0)) return;
  const double d = (from.d_m + to.d_m) / 2;
  const double h = (from.h_m + to.h_m) / 2;
  const double r2 = d * d + h * h;
  const double r = std::sqrt(r2);
  const double cos_incidence = std::min(1.0, std::abs(segment.normal_along * d + segment.normal_up * h) /
                                                 std::sqrt(r2 * segment.normal_length2));
  if (parts_.empty() || parts_.back().range_bin != bin || parts_.back().face != segment.face ||
      parts_.back().material != segment.material || parts_.back().raster_gamma != segment.raster_gamma) {
    PlatePart& part = parts_.emplace_back();
    part.range_bin = bin;
    part.face = segment.face;
    part.material = segment.material;
    part.raster_gamma = segment.raster_gamma;
  }
  PlatePart& part = parts_.back();
  part.share += share;
  const double mean_m = mean_power_range_m(from.range_m, to.range_m);
  part.over_range2 += share / (mean_m * mean_m);
  part.least_range_m = std::min({part.least_range_m, from.range_m, to.range_m});
  part.most_range_m = std::max({part.most_range_m, from.range_m, to.range_m});
  part.cos_incidence += share * cos_incidence;
  part.sin_elevation += share * h / r;
  part.d_m += share * d;
}

void Plate::drop_hidden(const std::vector<std::uint8_t>& visible, int kept_bin) {
  std::erase_if(parts_, [&](const PlatePart& part) {
    return part.range_bin != kept_bin && part.range_bin >= 0 &&
           part.range_bin < static_cast<int>(visible.size()) &&
           visible[static_cast<std::size_t>(part.range_bin)] == 0;
  });
}

const std::vector<PlatePart>& Plate::finish(double solid_angle_sr) {
  double sum = 0;
  for (const PlatePart& part : parts_) sum += part.share;
  // What is left of a segment that only touches a bin's edge would put light into it by rounding alone.
  std::erase_if(parts_, [&](const PlatePart& part) { return part.share < 1e-9 * sum; });
  sum = 0;
  for (const PlatePart& part : parts_) sum += part.share;
  for (PlatePart& part : parts_) {
    const double over_share = 1 / part.share;
    part.over_range2 *= over_share;
    part.cos_incidence *= over_share;
    part.sin_elevation *= over_share;
    part.d_m *= over_share;
    part.share *= solid_angle_sr / sum;
  }
  return parts_;
}

void emit_plate(const ScenePlan& plan, Plate& plate, const Sample& nearest, double sin_bearing,
                double cos_bearing, std::vector<Sample>& samples) {
  const std::vector<PlatePart>& parts = plate.finish(nearest.solid_angle_sr);
  const glm::dvec3& antenna = plan.sector().antenna_m;
  Sample sample = nearest;
  if (parts.empty()) {
    // From the hit's height, as the parts have it, not from the ray's direction.
    const double y_m = antenna.y + nearest.slant_range_m * nearest.sin_elevation;
    sample.sin_elevation = (y_m - antenna.y) / nearest.slant_range_m;
    samples.push_back(sample);
    return;
  }
  for (const PlatePart& part : parts) {
    sample.slant_range_m = part.range_m();
    sample.solid_angle_sr = part.share;
    sample.cos_incidence = part.cos_incidence;
    sample.sin_elevation = part.sin_elevation;
    sample.x_m = antenna.x + part.d_m * sin_bearing;
    sample.z_m = antenna.z + part.d_m * cos_bearing;
    sample.face = part.face;
    sample.material = part.material;
    sample.raster_gamma = part.raster_gamma;
    samples.push_back(sample);
  }
}

}  // namespace obliq
