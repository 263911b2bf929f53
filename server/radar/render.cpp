#include "server/radar/render.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/radar/echo/sea_echo.h"
#include "server/radar/echo/sea_texture.h"
#include "server/radar/geometry/antenna_velocity.h"
#include "server/radar/narrow_bins.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/sweep/sweep_samples.h"
#include "server/radar/visibility/coverage.h"
#include "server/radar/visibility/returns.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "server/radar/wedge_work.h"
#include "terrain/base/asking.h"
#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

void scatter_and_bin(const SampleBatch& samples, EchoBins& echo, FrameStats& stats) {
  const StageProbe probe(Stage::scatter);
  stats.samples += echo.add(samples);
}

/// By range bin.
void attenuate(const std::vector<double>& path_power, BinBlock& bins) {
  for (std::size_t bin = 0; bin < bins.power_w.size(); ++bin) {
    if (bin % path_power.size() == 0) ask(2 * static_cast<std::int64_t>(path_power.size()));
    const double factor = path_power[bin % path_power.size()];
    bins.power_w[bin] *= factor;
    bins.iq[bin] *= static_cast<float>(std::sqrt(factor));
  }
}

/// From samples to bins. rays/: generate rays, trace them to their first hits, refine those in double, spread
/// each pixel over bins. sweep/: find what each column's vertical planes see, cut it at the edges of bins.
void render_samples(WedgeWork& work, AzimuthRange range, HitObserver* observer, WedgeVisibility& visibility) {
  work.echo.restart(range);
  {
    std::unique_ptr<SampleSource> source;  // gone before the sums, so that its memory is free for them
    {
      const StageProbe probe(Stage::bin);
      source = make_sample_source(work.plan, range, observer, &visibility);
    }
    while (source->fill(work.samples, work.wedge.stats))
      scatter_and_bin(work.samples, work.echo, work.wedge.stats);
  }
  const StageProbe probe(Stage::bin);
  work.echo.write(work.wedge.bins);
}

/// Where it can, the sweep goes from what its planes see to echoes in one step.
void render_echoes(WedgeWork& work, AzimuthRange range, double far_m) {
  work.cells.restart(range.first);
  SweepEchoes sweep(work.plan, range, work.tables.near_buildings, work.tables.scattering, work.cells, far_m);
  sweep.run(work.wedge.stats);
  const StageProbe probe(Stage::bin);
  work.cells.write(work.wedge.bins);
  sweep.write_returns(work.wedge.bins);
  work.wedge.stats.hits += work.cells.count();
  work.wedge.stats.samples += work.cells.count();
}

/// Of labels, where the sweep has not counted them.
void add_returns(const ScenePlan& plan, BinBlock& bins) {
  bins.labels.returns.resize(bins.state.size());
  for (int a = 0; a < bins.n_azimuth; ++a)
    count_returns(plan, bins.first_azimuth + a,
                  bins.labels.returns.data() + std::ptrdiff_t{a} * bins.n_range);
}

/// work.wedge becomes a wedge of bins that are looked at, without its area and the count of its states.
void look_at(WedgeWork& work, int index, const WedgeSums::Needed& needed) {
  const int bin = index * kWedgeAzimuthBins;
  const AzimuthRange range{bin, std::min(kWedgeAzimuthBins, work.plan.settings().azimuth_bins - bin)};
  work.wedge = {};
  work.wedge.index = index;
  work.wedge.bins = BinBlock(range.first, range.count, work.plan.bins().n_range);
  ask(static_cast<std::int64_t>(work.wedge.bins.state.size()));
  const bool echoes = has_sub_columns(work.plan);
  WedgeVisibility visibility(work.plan, range, !echoes);
  if (echoes) {
    render_echoes(work, range, needed.far_m);
  } else {
    render_samples(work, range, needed.observer, visibility);
  }
  if (!work.tables.path_power.empty()) attenuate(work.tables.path_power, work.wedge.bins);
  if (needed.returns && work.wedge.bins.labels.returns.empty()) {
    const StageProbe probe(Stage::states);
    add_returns(work.plan, work.wedge.bins);
  }
  if (!needed.states) return;
  const StageProbe probe(Stage::states);
  decide_states(work.plan, visibility, work.wedge.bins);
}

/// The same of wide bins, from their narrow ones.
void add_up(WedgeWork& work, int index, const WedgeSums::Needed& needed) {
  const int n = work.narrow_bins;
  const int all = work.plan.settings().azimuth_bins;
  const int bin = index * kWedgeAzimuthBins;
  Wedge sum;
  sum.index = index;
  sum.bins = BinBlock(bin, std::min(kWedgeAzimuthBins, all / n - bin), work.plan.bins().n_range);
  ask(static_cast<std::int64_t>(sum.bins.state.size()));
  for (int narrow = index * n; narrow < std::min((index + 1) * n, wedge_count(all)); ++narrow) {
    look_at(work, narrow, needed);
    const StageProbe probe(Stage::bin);
    add_narrow(work.wedge.bins, n, sum.bins);
    sum.stats.add(work.wedge.stats);
  }
  work.wedge = std::move(sum);
}

}  // namespace

void count_states(Wedge& wedge) {
  const auto of = [&](BinState state) {
    return static_cast<std::uint64_t>(std::ranges::count(wedge.bins.state, static_cast<std::uint8_t>(state)));
  };
  wedge.stats.unsampled_bins = of(BinState::not_sampled);
  wedge.stats.lit_bins = of(BinState::sampled) + wedge.stats.unsampled_bins;
}

void measure_coverage(const FramePlan& plan, Wedge& wedge) {
  const StageProbe probe(Stage::states);
  for (int k = 0; k < wedge.bins.n_azimuth; ++k) {
    const GroundArea area = ground_area(plan, wedge.bins.first_azimuth + k);
    wedge.stats.sector_area_m2 += area.sector_m2;
    wedge.stats.covered_area_m2 += area.covered_m2;
  }
}

void render_wedge(WedgeWork& work, int index, const WedgeSums::Needed& needed) {
  if (work.narrow_bins == 1) {
    look_at(work, index, needed);
  } else {
    add_up(work, index, needed);
  }
  if (!needed.states) return;
  const StageProbe probe(Stage::states);
  ask(static_cast<std::int64_t>(work.wedge.bins.state.size()));
  count_states(work.wedge);
}

std::unique_ptr<SampleSource> make_sample_source(const ScenePlan& plan, AzimuthRange range,
                                                 HitObserver* observer, WedgeVisibility* profile) {
  if (plan.settings().frustum == FrustumKind::sweep) return std::make_unique<SweepSamples>(plan, range);
  return std::make_unique<RaySamples>(plan, range, observer, profile);
}

FrameTables::FrameTables(const ScenePlan& plan)
    : scattering(
          plan.scene().materials(), plan.wavelength_m(),
          plan.scene().world().buildings.corners && plan.scene().world().buildings.walls
              ? std::optional(CornerTable(plan.scene().materials(), plan.settings().atmosphere.polarisation))
              : std::nullopt,
          {sea_table(plan), sea_texture(plan)}),
      speckle(plan.scene().world(), plan.sector().antenna_m, plan.wavelength_m(), plan.bins().range_spacing_m,
              plan.bins().azimuth_width_rad, plan.settings().speckle_seed,
              {plan.bins(), 1 / plan.bins().azimuth_width_rad, plan.is_coherent_sum(),
               plan.settings().frustum == FrustumKind::sweep && plan.bins().azimuth_width_rad < 1}),
      near_buildings(plan) {
  if (!attenuates(plan.settings())) return;
  const double loss_db_km = path_loss_db_km(plan.settings(), air_view(plan));
  ask(20 * std::int64_t{plan.bins().n_range});
  for (int bin = 0; bin < plan.bins().n_range; ++bin)
    path_power.push_back(
        path_power_factor(loss_db_km, plan.bins().r_min_m + (bin + 0.5) * plan.bins().range_spacing_m));
}

AirView air_view(const ScenePlan& plan) {
  double across_m_s = 0;
  if (plan.settings().mode == RadarMode::sar) {
    const glm::dvec3 v = antenna_velocity_m_s(plan.scene().world(), plan.pose());
    across_m_s = std::abs(v.x * plan.sector().cos_bearing - v.z * plan.sector().sin_bearing);
  }
  return {plan.scene().world().frame.geodetic_from_world(plan.pose().antenna).height_m,
          plan.extent().median_height_m, plan.antenna_gain().tilt_rad(), across_m_s};
}

std::uint64_t frame_draw(std::string_view radar, std::uint64_t counter) {
  return mix64(checksum(radar.data(), radar.size()) ^ mix64(counter));
}

FrameStats FrameSum::total() const {
  FrameStats total;
  for (const FrameStats& wedge : wedges_) total.add(wedge);
  return total;
}

Frame render(std::shared_ptr<const Scene> scene, SettingsPtr settings, const Pose& pose,
             AzimuthRange azimuths, const RenderOptions& options) {
  const PlanResult planned = plan_frame(std::move(scene), std::move(settings), pose);
  if (!planned.plan) throw InputError(all_text(planned.errors));
  const FramePlan& plan = *planned.plan;
  Frame frame;
  frame.bins = BinBlock(azimuths.first, azimuths.count, plan.bins().n_range);
  FrameSum sum(plan.settings());
  const Receiver own(plan.settings(), "", plan.settings().receiver.noise_frame, air_view(plan.looks_at()));
  RenderOptions with_copy = options;
  if (with_copy.receiver == nullptr) with_copy.receiver = &own;
  with_copy.on_wedge = [&](Wedge&& wedge) {
    sum.add(wedge);
    copy_azimuths(wedge.bins, frame.bins);
    if (options.on_wedge) options.on_wedge(std::move(wedge));
  };
  render_wedges(plan, azimuths, with_copy);
  frame.stats = sum.total();
  return frame;
}

}  // namespace obliq
