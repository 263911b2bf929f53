#include "server/radar/wedge_bins.h"

#include <cmath>
#include <numbers>

#include "server/radar/antenna_pattern.h"
#include "server/radar/exact_math.h"

namespace obliq {
namespace {

/// The shortest wavelength that is allowed. The radar equation is one of the far field: nearer than this it
/// means nothing, and at 0, an antenna against a wall, it divides by it.
constexpr double kNearest_m = 1e-3;

}  // namespace

WedgeBins::WedgeBins(const FramePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
                     AzimuthRange range, Surfaces surfaces)
    : plan_(plan), scattering_(scattering), speckle_(speckle), range_(range), surfaces_(surfaces) {
  const double four_pi = 4 * std::numbers::pi;
  const double lambda = plan.wavelength_m();
  range_constant_ = plan.settings().power_w * lambda * lambda / (four_pi * four_pi * four_pi);
  const std::size_t n = static_cast<std::size_t>(range.count) * static_cast<std::size_t>(plan.bins().n_range);
  power_w_.resize(n);
  count_.resize(n);
  if (plan.settings().speckle == SpeckleKind::geometric) {
    voltage_.resize(n);
  } else {
    tables_.resize(static_cast<std::size_t>(range.count));
    for (Table& table : tables_) table.slots.assign(std::size_t{1} << 11, 0);
  }
}

std::uint64_t WedgeBins::add(const SampleBatch& samples) {
  const BinGrid& bins = plan_.bins();
  const AntennaPattern pattern(plan_.settings().gain_db);
  const bool normalise = plan_.settings().range_normalisation;
  const bool geometric = !voltage_.empty();
  std::uint64_t binned = 0;
  for (int s = 0; s < samples.n; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const double r = samples.slant_range_m[k];
    const int range_bin = bins.range_bin(r);
    if (range_bin < 0 || r < kNearest_m) continue;
    if (surfaces_ != Surfaces::all && (samples.face[k] == kNoFace) != (surfaces_ == Surfaces::ground))
      continue;
    const double r2 = r * r;
    const double sigma = scattering_.cross_section_m2(samples.material[k], samples.solid_angle_sr[k] * r2,
                                                      samples.cos_incidence[k]);
    // Monostatic radar equation (Richards 2014, eq. 2.8); the normalised image drops 1 / r^4.
    const double gain = pattern.power_gain(samples.azimuth_offset_rad[k], samples.sin_elevation[k]);
    const double power = range_constant_ * gain * gain * sigma / (normalise ? 1.0 : r2 * r2);
    const auto bin =
        static_cast<std::uint32_t>((samples.azimuth_bin[k] - range_.first) * bins.n_range + range_bin);
    power_w_[bin] += power;
    ++count_[bin];
    ++binned;
    if (samples.face[k] != kNoFace)
      plan_.mark_building_seen(plan_.scene().world().buildings.faces[samples.face[k]].building);
    if (geometric) {
      const double round_trips = 2 * r / plan_.wavelength_m();
      const SinCos at = sincos_turns(-(round_trips - std::floor(round_trips)));
      const double amplitude = std::sqrt(power);
      voltage_[bin] += std::complex<double>(amplitude * at.cos, amplitude * at.sin);
    } else {
      add_to_group(
          speckle_.scatterer(r, samples.x_m[k], samples.z_m[k], samples.face[k], samples.material[k]), bin,
          power);
    }
  }
  return binned;
}

void WedgeBins::add_to_group(const Scatterer& scatterer, std::uint32_t bin, double power_w) {
  Table& table = tables_[bin / static_cast<std::uint32_t>(plan_.bins().n_range)];
  const std::size_t mask = table.slots.size() - 1;
  std::size_t slot = static_cast<std::size_t>(hash(scatterer, bin)) & mask;
  for (; table.slots[slot] != 0; slot = (slot + 1) & mask) {
    Group& group = groups_[table.slots[slot] - 1];
    if (group.bin == bin && group.scatterer == scatterer) {
      group.power_w += power_w;
      return;
    }
  }
  groups_.push_back({scatterer, bin, power_w});
  table.slots[slot] = static_cast<std::uint32_t>(groups_.size());
  if (2 * ++table.used > table.slots.size()) grow(table);
}

void WedgeBins::grow(Table& table) {
  std::vector<std::uint32_t> old(2 * table.slots.size(), 0);
  old.swap(table.slots);
  const std::size_t mask = table.slots.size() - 1;
  for (const std::uint32_t number : old) {
    if (number == 0) continue;
    const Group& group = groups_[number - 1];
    std::size_t slot = static_cast<std::size_t>(hash(group.scatterer, group.bin)) & mask;
    while (table.slots[slot] != 0) slot = (slot + 1) & mask;
    table.slots[slot] = number;
  }
}

void WedgeBins::write(BinBlock& block) const {
  std::vector<std::complex<double>> voltage = voltage_;
  if (voltage.empty()) {
    voltage.resize(power_w_.size());
    for (const Group& group : groups_)
      voltage[group.bin] += std::sqrt(group.power_w) * speckle_.response(group.scatterer);
  }
  for (std::size_t bin = 0; bin < power_w_.size(); ++bin) {
    block.iq[bin] = std::complex<float>(voltage[bin]);
    block.power_w[bin] = power_w_[bin];
    block.count[bin] = count_[bin];
    if (count_[bin] > 0) block.state[bin] = static_cast<std::uint8_t>(BinState::sampled);
  }
}

}  // namespace obliq
