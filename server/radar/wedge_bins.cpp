#include "server/radar/wedge_bins.h"

#include <algorithm>
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
  restart(range);
}

void WedgeBins::restart(AzimuthRange range) {
  range_ = range;
  const std::size_t n =
      static_cast<std::size_t>(range.count) * static_cast<std::size_t>(plan_.bins().n_range);
  power_w_.assign(n, 0);
  count_.assign(n, 0);
  voltage_.assign(n, 0);
  groups_.clear();
  if (plan_.settings().speckle == SpeckleKind::geometric) return;
  chains_.assign(n, {});
  entered_ = 0;
  table_.assign(std::max(table_.size(), std::size_t{1} << 13), 0);
}

std::uint64_t WedgeBins::add(const SampleBatch& samples) {
  const BinGrid& bins = plan_.bins();
  const AntennaPattern pattern(plan_.settings().gain_db);
  const bool normalise = plan_.settings().range_normalisation;
  const bool geometric = plan_.settings().speckle == SpeckleKind::geometric;
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
  // Most bins have a handful of scatterers: their list is searched, the latest first. Only the groups of bins
  // with many are in the table as well.
  Chain& chain = chains_[bin];
  if (chain.length < kLongChain) {
    for (std::uint32_t at = chain.last; at != 0; at = groups_[at - 1].previous) {
      if (groups_[at - 1].scatterer != scatterer) continue;
      groups_[at - 1].power_w += power_w;
      return;
    }
  } else {
    const std::size_t mask = table_.size() - 1;
    for (std::size_t slot = slot_of(scatterer, bin); table_[slot] != 0; slot = (slot + 1) & mask) {
      Group& group = groups_[table_[slot] - 1];
      if (group.bin != bin || group.scatterer != scatterer) continue;
      group.power_w += power_w;
      return;
    }
  }
  groups_.push_back({scatterer, bin, chain.last, power_w});
  chain.last = static_cast<std::uint32_t>(groups_.size());
  ++chain.length;
  if (chain.length > kLongChain) enter(chain.last);
  if (chain.length != kLongChain) return;
  for (std::uint32_t at = chain.last; at != 0; at = groups_[at - 1].previous) enter(at);
}

std::size_t WedgeBins::slot_of(const Scatterer& scatterer, std::uint32_t bin) const {
  return static_cast<std::size_t>(speckle_.hash(scatterer) + bin * 0x9e3779b97f4a7c15ull) &
         (table_.size() - 1);
}

/// Enters a group, by its number + 1, into the table.
void WedgeBins::enter(std::uint32_t group) {
  if (2 * (entered_ + 1) > table_.size()) grow_table();
  ++entered_;
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = slot_of(groups_[group - 1].scatterer, groups_[group - 1].bin);
  while (table_[slot] != 0) slot = (slot + 1) & mask;
  table_[slot] = group;
}

void WedgeBins::grow_table() {
  const std::vector<std::uint32_t> entries = std::move(table_);
  table_.assign(2 * entries.size(), 0);
  entered_ = 0;
  for (const std::uint32_t group : entries)
    if (group != 0) enter(group);
}

void WedgeBins::write(BinBlock& block) {
  Scatterer scatterers[SpeckleBlock::kMost];
  SpeckleBlock responses{};
  for (std::size_t first = 0; first < groups_.size(); first += SpeckleBlock::kMost) {
    responses.n = static_cast<int>(std::min<std::size_t>(SpeckleBlock::kMost, groups_.size() - first));
    const Group* const group = groups_.data() + first;
    for (int k = 0; k < responses.n; ++k) {
      scatterers[k] = group[k].scatterer;
      responses.power_w[k] = group[k].power_w;
    }
    speckle_.respond(scatterers, responses);
    for (int k = 0; k < responses.n; ++k)
      voltage_[group[k].bin] += std::complex<double>(responses.re[k], responses.im[k]);
  }
  groups_.clear();
  for (std::size_t bin = 0; bin < power_w_.size(); ++bin) {
    block.iq[bin] = std::complex<float>(voltage_[bin]);
    block.power_w[bin] = power_w_[bin];
    block.count[bin] = count_[bin];
    if (count_[bin] > 0) block.state[bin] = static_cast<std::uint8_t>(BinState::sampled);
  }
}

}  // namespace obliq
