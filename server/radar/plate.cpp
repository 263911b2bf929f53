#include "server/radar/plate.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// The bin of a range, -1 and n_range for those before and behind the swath.
int bin_or_outside(const BinGrid& bins, double r_m) {
  if (r_m < bins.r_min_m) return -1;
  if (r_m >= bins.r_max_m) return bins.n_range;
  return bins.range_bin(r_m);
}

}  // namespace

void Plate::add(const BinGrid& bins, const PlanePiece& piece) {
  const double dd = piece.far_d_m - piece.near_d_m;
  const double dh = piece.far_h_m - piece.near_h_m;
  const double along = -(piece.near_d_m * dd + piece.near_h_m * dh);
  const double length2 = dd * dd + dh * dh;
  if (along > 0 && along < length2) {
    const double d = piece.near_d_m + along / length2 * dd;
    const double h = piece.near_h_m + along / length2 * dh;
    add_monotone(bins, piece, piece.near_d_m, piece.near_h_m, d, h);
    add_monotone(bins, piece, d, h, piece.far_d_m, piece.far_h_m);
  } else {
    add_monotone(bins, piece, piece.near_d_m, piece.near_h_m, piece.far_d_m, piece.far_h_m);
  }
}

void Plate::add_monotone(const BinGrid& bins, const PlanePiece& piece, double d0, double h0, double d1,
                         double h1) {
  const double r0 = std::sqrt(d0 * d0 + h0 * h0);
  const double r1 = std::sqrt(d1 * d1 + h1 * h1);
  if (!(r0 > 0 && r1 > 0)) return;
  int bin = bin_or_outside(bins, r0);
  const int last = bin_or_outside(bins, r1);
  double sin0 = h0 / r0;
  const double sin_end = h1 / r1;
  if (bin != last) {
    // Where |A + t D| = R: t = foot +- sqrt(R^2 - |A|^2 + foot^2 |D|^2) / |D|.
    const double dd = d1 - d0;
    const double dh = h1 - h0;
    const double length2 = dd * dd + dh * dh;
    const double foot = -(d0 * dd + h0 * dh) / length2;
    const double nearest2 = d0 * d0 + h0 * h0 - foot * foot * length2;
    const int step = last > bin ? 1 : -1;
    double d = d0;
    double h = h0;
    for (; bin != last; bin += step) {
      const double edge_m = bins.r_min_m + (step > 0 ? bin + 1 : bin) * bins.range_spacing_m;
      const double root = std::sqrt(std::max(0.0, (edge_m * edge_m - nearest2) / length2));
      const double t = std::clamp(foot + step * root, 0.0, 1.0);
      const double d_cut = d0 + t * dd;
      const double h_cut = h0 + t * dh;
      const double sin_cut = h_cut / edge_m;
      add_part(bin, piece, d, h, d_cut, h_cut, sin_cut - sin0);
      d = d_cut;
      h = h_cut;
      sin0 = sin_cut;
    }
    add_part(bin, piece, d, h, d1, h1, sin_end - sin0);
  } else {
    add_part(bin, piece, d0, h0, d1, h1, sin_end - sin0);
  }
}

void Plate::add_part(int bin, const PlanePiece& piece, double d0, double h0, double d1, double h1,
                     double share) {
  if (!(share > 0)) return;
  const double d = (d0 + d1) / 2;
  const double h = (h0 + h1) / 2;
  const double r = std::sqrt(d * d + h * h);
  const double cos_incidence = std::min(1.0, std::abs(piece.normal_along * d + piece.normal_up * h) / r);
  if (parts_.empty() || parts_.back().range_bin != bin || parts_.back().face != piece.face ||
      parts_.back().material != piece.material) {
    PlatePart& part = parts_.emplace_back();
    part.range_bin = bin;
    part.face = piece.face;
    part.material = piece.material;
  }
  PlatePart& part = parts_.back();
  part.share += share;
  part.range_m += share * r;
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
  // What is left of a piece that only touches a bin's edge would put light into it by rounding alone.
  std::erase_if(parts_, [&](const PlatePart& part) { return part.share < 1e-9 * sum; });
  sum = 0;
  for (const PlatePart& part : parts_) sum += part.share;
  for (PlatePart& part : parts_) {
    const double over_share = 1 / part.share;
    part.range_m *= over_share;
    part.cos_incidence *= over_share;
    part.sin_elevation *= over_share;
    part.d_m *= over_share;
    part.share *= solid_angle_sr / sum;
  }
  return parts_;
}

void emit_plate(const FramePlan& plan, Plate& plate, const ExactHit& hit, double solid_angle_sr,
                int azimuth_bin, double sin_bearing, double cos_bearing, std::vector<Sample>& samples) {
  Sample sample;
  sample.azimuth_bin = azimuth_bin;
  sample.azimuth_offset_rad = plan.bins().azimuth_edge_rad(azimuth_bin + 0.5);
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const std::vector<PlatePart>& parts = plate.finish(solid_angle_sr);
  for (const PlatePart& part : parts) {
    sample.slant_range_m = part.range_m;
    sample.solid_angle_sr = part.share;
    sample.cos_incidence = part.cos_incidence;
    sample.sin_elevation = part.sin_elevation;
    sample.x_m = antenna.x + part.d_m * sin_bearing;
    sample.z_m = antenna.z + part.d_m * cos_bearing;
    sample.face = part.face;
    sample.material = part.material;
    samples.push_back(sample);
  }
  if (!parts.empty()) return;
  sample.slant_range_m = hit.slant_range_m;
  sample.solid_angle_sr = solid_angle_sr;
  sample.cos_incidence = hit.cos_incidence;
  sample.sin_elevation = (hit.position_m.y - antenna.y) / hit.slant_range_m;
  sample.x_m = hit.position_m.x;
  sample.z_m = hit.position_m.z;
  sample.face = hit.face;
  sample.material = hit.material;
  samples.push_back(sample);
}

}  // namespace obliq
