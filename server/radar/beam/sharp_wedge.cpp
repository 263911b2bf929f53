#include "server/radar/beam/sharp_wedge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {

std::size_t sharp_stride(const EchoPlan& plan) { return plan.steepest.size() * EchoPlan::kTile; }

SharpWedge::SharpWedge(const EchoPlan& plan, BinBlock&& bins, const FrameStats& of_bins,
                       const SharpPlanes& planes, std::uint64_t look_key)
    : first_azimuth(bins.first_azimuth),
      n_azimuth(bins.n_azimuth),
      n_range(bins.n_range),
      stride(sharp_stride(plan)),
      count(std::move(bins.count)),
      state(std::move(bins.state)),
      stats(of_bins) {
  fill(power, static_cast<std::size_t>(n_azimuth) * stride, 0);
  if (planes.iq) fill(iq, 2 * power.size(), 0);
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
    ask(n_range);
    for (std::size_t r = 0; r < static_cast<std::size_t>(n_range); ++r) {
      const std::size_t from = a * static_cast<std::size_t>(n_range) + r;
      const std::size_t to = a * stride + r;
      const float amplitude = plan.amplitude.empty() ? 1.0F : plan.amplitude[r];
      power[to] = static_cast<float>(bins.power_w[from]) * (amplitude * amplitude);
      if (!planes.iq) continue;
      iq[2 * to] = bins.iq[from].real() * amplitude;
      iq[2 * to + 1] = bins.iq[from].imag() * amplitude;
    }
  }
  if (plan.ground) {
    see(*plan.ground, bins);
  } else {
    choose_kernels(bins);
    if (plan.doppler) take_sines(bins);
  }
  if (planes.labels != LabelParts::none) take_labels(bins);
  if (planes.look && !plan.ground) draw_look(plan, look_key);
}

SharpWedge::SharpWedge(const EchoPlan& plan, AzimuthRange azimuths, const SharpPlanes& planes)
    : first_azimuth(azimuths.first),
      n_azimuth(azimuths.count),
      n_range(plan.sharp.range_bins),
      stride(sharp_stride(plan)) {
  const auto bins = static_cast<std::size_t>(n_azimuth) * static_cast<std::size_t>(n_range);
  fill(power, static_cast<std::size_t>(n_azimuth) * stride, 0);
  if (planes.iq) fill(iq, 2 * power.size(), 0);
  fill(kernels, power.size() / EchoPlan::kTile, 0);
  if (plan.doppler) fill(mean_sine, power.size(), 0);
  fill(count, bins, 0);
  fill(state, bins, 0);
  if (planes.labels != LabelParts::none) fill(returns, bins, 0);
}

std::vector<float>& SharpWedge::label_row_of(int kind) {
  const auto at = std::ranges::find(label_powers, kind, &LabelShare::kind);
  if (at != label_powers.end()) return at->share;
  std::vector<float>& row = label_powers.emplace_back(LabelShare{kind, {}}).share;
  fill(row, power.size(), 0);
  return row;
}

/// Where the antenna sees what the bins hold, by the elevation that they keep of it.
void SharpWedge::see(const GroundAzimuths& ground, const BinBlock& bins) {
  constexpr double kFlat = 0.2;  // a tangent whose series is short
  fill(kernels, power.size() / EchoPlan::kTile, 0);
  fill(seen_at, power.size(), 0);
  fill(own_sine, power.size(), 0);
  const glm::dvec3& up = ground.axes.up();
  for (int a = 0; a < n_azimuth; ++a) {
    ask(4 * std::int64_t{n_range});
    const double azimuth_rad = ground.start_rad + (first_azimuth + a + 0.5) * ground.azimuth_rad;
    const SinCos azimuth = sincos_turns(azimuth_rad / (2 * std::numbers::pi));
    // Bins keep y = sin e + q cos e, the sine about the antenna's own vertical over its rise.
    const double q = (up.x * azimuth.cos + up.y * azimuth.sin) / up.z;
    glm::dvec3 before{0, 0, 0};
    double before_rad = 0;
    for (int r = 0; r < n_range; ++r) {
      const std::size_t at = row_at(first_azimuth + a) + static_cast<std::size_t>(r);
      if (!(power[at] > 0)) continue;
      const std::size_t bin =
          static_cast<std::size_t>(a) * static_cast<std::size_t>(n_range) + static_cast<std::size_t>(r);
      const auto y = static_cast<double>(bins.sin_elevation[bin]);
      const double root = std::sqrt(std::max(0.0, 1 + q * q - y * y));
      const double cosine = std::max(0.0, (q * y + root) / (1 + q * q));
      const double sine = (y - q * root) / (1 + q * q);
      const glm::dvec3 own = ground.axes.own({cosine * azimuth.cos, cosine * azimuth.sin, sine});
      const double across = before.x * own.y - before.y * own.x;
      const double along = before.x * own.x + before.y * own.y;
      double angle_rad = 0;
      if (along > 0 && std::abs(across) < kFlat * along) {
        const double t = across / along;
        const double z = t * t;
        angle_rad = before_rad + t * (1 + z * (-1.0 / 3 + z * (1.0 / 5 + z * (-1.0 / 7 + z / 9))));
      } else {
        before = own;
        angle_rad = before_rad = bearing_of(own.y, own.x);
      }
      seen_at[at] = static_cast<float>((angle_rad - ground.scan_start_rad) / ground.azimuth_rad - 0.5);
      own_sine[at] = static_cast<float>(own.z);
    }
  }
}

void SharpWedge::choose_kernels(const BinBlock& bins) {
  fill(kernels, power.size() / EchoPlan::kTile, 0);
  if (bins.sin_elevation.empty()) return;
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
    ask(n_range);
    const std::size_t own = a * static_cast<std::size_t>(n_range);
    for (int first = 0; first < n_range; first += EchoPlan::kTile) {
      double power_w = 0;
      double sines_w = 0;
      for (int r = first; r < std::min(first + EchoPlan::kTile, n_range); ++r) {
        const std::size_t bin = own + static_cast<std::size_t>(r);
        power_w += bins.power_w[bin];
        sines_w += bins.power_w[bin] * static_cast<double>(bins.sin_elevation[bin]);
      }
      if (power_w > 0)
        kernels[(a * stride + static_cast<std::size_t>(first)) / EchoPlan::kTile] =
            static_cast<std::uint8_t>(cosine_steps::nearest(sines_w / power_w));
    }
  }
}

void SharpWedge::take_sines(const BinBlock& bins) {
  fill(mean_sine, power.size(), 0);
  if (bins.sin_elevation.empty()) return;
  const auto n = static_cast<std::size_t>(n_range);
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a)
    std::copy_n(bins.sin_elevation.data() + a * n, n, mean_sine.data() + a * stride);
}

void SharpWedge::take_labels(BinBlock& bins) {
  returns = std::move(bins.labels.returns);
  if (returns.empty()) fill(returns, state.size(), 0);  // of a halo, where nobody asks
  for (const LabelShare& share : bins.label_shares) {
    std::vector<float>& row = label_powers.emplace_back(LabelShare{share.kind, power}).share;
    for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
      ask(n_range);
      const float* const of_bins = share.share.data() + a * static_cast<std::size_t>(n_range);
      for (std::size_t r = 0; r < static_cast<std::size_t>(n_range); ++r) row[a * stride + r] *= of_bins[r];
    }
  }
}

std::uint64_t first_of_sharp_row(const EchoPlan& plan, int azimuth) {
  constexpr std::uint64_t kBeside = std::uint64_t{1} << 30;  // more bins than a halo has
  const std::uint64_t row =
      kBeside + static_cast<std::uint64_t>(azimuth) - static_cast<std::uint64_t>(plan.first_azimuth);
  return (row << 32) + kBeside - static_cast<std::uint64_t>(plan.first_range);
}

void draw_sharp_row(const EchoPlan& plan, int azimuth, std::uint64_t key, const float* power, float* iq) {
  const std::size_t stride = sharp_stride(plan);
  ask(2 * static_cast<std::int64_t>(stride));
  active_kernels().draw_speckle(
      {key, first_of_sharp_row(plan, azimuth), static_cast<int>(stride), power, iq});
}

void SharpWedge::draw_look(const EchoPlan& plan, std::uint64_t key) {
  fill(look, 2 * power.size(), 0);
  for (int a = first_azimuth; a < first_azimuth + n_azimuth; ++a)
    draw_sharp_row(plan, a, key, power_row(a), look.data() + 2 * row_at(a));
}

std::size_t SharpWedge::bytes() const {
  return (iq.size() + look.size() + power.size()) * sizeof(float) + count.size() * sizeof(std::uint32_t) +
         state.size() + mean_sine.size() * sizeof(float) + kernels.size() + returns.size() +
         (seen_at.size() + own_sine.size()) * sizeof(float) +
         label_powers.size() * power.size() * sizeof(float);
}

}  // namespace obliq
