#include "server/radar/render.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "server/radar/batches.h"
#include "server/radar/frame_plan.h"
#include "server/radar/profile.h"
#include "server/radar/sample_source.h"
#include "server/radar/scattering.h"
#include "server/radar/speckle.h"
#include "server/radar/wedge_bins.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

/// What the wedges of a frame share besides the plan.
struct FrameTables {
  ScatteringTable scattering;
  SpeckleField speckle;

  explicit FrameTables(const FramePlan& plan)
      : scattering(plan.scene().materials(), plan.wavelength_m()),
        speckle(plan.scene().world(), plan.sector().antenna_m, plan.wavelength_m(),
                plan.bins().range_spacing_m, plan.bins().azimuth_width_rad, plan.settings().speckle_seed) {}
};

/// The buffers of one thread, reused from wedge to wedge.
struct Workspace {
  SampleBatch samples;
  std::vector<FootprintSpan> spans;
  ProfileResult profile;
};

/// What the strands of one azimuth bin found together.
struct BinProfile {
  std::vector<std::uint8_t> visible, present;  // [n_range]

  void clear(std::size_t n_range) {
    visible.assign(n_range, 0);
    present.assign(n_range, 0);
  }
  void add(const ProfileResult& strand) {
    for (std::size_t r = 0; r < visible.size(); ++r) {
      visible[r] |= strand.visible[r];
      present[r] |= strand.present[r];
    }
  }
};

void write_states(const BinProfile& profile, std::uint8_t* state) {
  for (std::size_t r = 0; r < profile.visible.size(); ++r) {
    if (state[r] == static_cast<std::uint8_t>(BinState::sampled)) continue;
    const BinState decided = profile.visible[r]   ? BinState::not_sampled
                             : profile.present[r] ? BinState::shadow
                                                  : BinState::no_surface;
    state[r] = static_cast<std::uint8_t>(decided);
  }
}

/// Gives every bin without samples its state, and measures coverage along the bins' centres. Neighbours share
/// the strand between them; an azimuth bin that needs no states is marched along its centre alone.
void decide_states(const FramePlan& plan, bool states, Workspace& work, Wedge& wedge) {
  const auto n_range = static_cast<std::size_t>(plan.bins().n_range);
  const int strands = profile_strands(plan);
  BinProfile here, edge;
  bool edge_known = false;
  for (int a = 0; a < wedge.bins.n_azimuth; ++a) {
    std::uint8_t* state = wedge.bins.state.data() + static_cast<std::size_t>(a) * n_range;
    const bool undecided = states && std::any_of(state, state + n_range, [](std::uint8_t value) {
                             return value != static_cast<std::uint8_t>(BinState::sampled);
                           });
    const int first_strand = edge_known ? 1 : 0;
    if (edge_known) {
      here = edge;
    } else {
      here.clear(n_range);
    }
    edge_known = false;
    for (int strand = first_strand; strand <= strands; ++strand) {
      const bool centre = 2 * strand == strands;
      if (!centre && !undecided) continue;
      march_profile(plan, wedge.bins.first_azimuth + a + static_cast<double>(strand) / strands, work.spans,
                    work.profile);
      here.add(work.profile);
      if (centre) {
        wedge.stats.sector_area_m2 += work.profile.sector_area_m2;
        wedge.stats.covered_area_m2 += work.profile.covered_area_m2;
      }
      if (strand == strands) {
        edge.clear(n_range);
        edge.add(work.profile);
        edge_known = true;
      }
    }
    if (undecided) write_states(here, state);
  }
}

Wedge render_wedge(const FramePlan& plan, const FrameTables& tables, int index, AzimuthRange range,
                   const RenderOptions& options, Workspace& work) {
  Wedge wedge;
  wedge.index = index;
  wedge.bins = BinBlock(range.first, range.count, plan.bins().n_range);
  WedgeBins bins(plan, tables.scattering, tables.speckle, range, options.surfaces);
  const auto source = make_sample_source(plan, range, options.tap);
  while (source->next(work.samples, wedge.stats)) wedge.stats.samples += bins.add(work.samples);
  bins.write(wedge.bins);
  decide_states(plan, options.states, work, wedge);
  return wedge;
}

}  // namespace

int wedge_count(const RadarSettings& settings) {
  return (settings.azimuth_bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins;
}

FrameStats FrameSum::total() const {
  FrameStats total;
  for (const FrameStats& wedge : wedges_) total.add(wedge);
  return total;
}

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const FrameTables tables(plan);
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings()),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  std::atomic<int> next{first};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  std::mutex delivery;

  const auto work_until_done = [&] {
    const auto work = std::make_unique<Workspace>();
    for (int index = next++; index < end; index = next++) {
      if (options.stop.stop_requested() || failed) return;
      try {
        if (options.before_wedge) options.before_wedge(index);
        const int bin = index * kWedgeAzimuthBins;
        const AzimuthRange range{bin, std::min(kWedgeAzimuthBins, plan.settings().azimuth_bins - bin)};
        Wedge wedge = render_wedge(plan, tables, index, range, options, *work);
        const std::scoped_lock lock(delivery);
        if (options.on_wedge && !failed) options.on_wedge(std::move(wedge));
      } catch (...) {
        if (!failed.exchange(true)) failure = std::current_exception();
        return;
      }
    }
  };

  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(work_until_done);
    work_until_done();
  }
  if (failure) std::rethrow_exception(failure);
  return !options.stop.stop_requested();
}

Frame render(std::shared_ptr<const Scene> scene, SettingsPtr settings, const Pose& pose,
             AzimuthRange azimuths, const RenderOptions& options) {
  const PlanResult planned = plan_frame(std::move(scene), std::move(settings), pose);
  if (!planned.plan) throw InputError(all_text(planned.errors));
  const FramePlan& plan = *planned.plan;
  Frame frame;
  frame.bins = BinBlock(azimuths.first, azimuths.count, plan.bins().n_range);
  FrameSum sum(plan.settings());
  RenderOptions with_copy = options;
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
