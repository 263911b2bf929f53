#pragma once
// A wedge on its way through the pipeline: what render_wedge (server/radar/render.cpp) works on.
#include <functional>
#include <memory>
#include <optional>

#include "server/radar/beam/echo_sums.h"
#include "server/radar/echo/echo_bins.h"
#include "server/radar/echo/echo_cells.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/render.h"
#include "server/radar/sweep/sweep_echoes.h"
#include "server/radar/visibility/wedge_visibility.h"

namespace obliq {

/// What the wedges of a frame share besides the plan. Immutable.
struct FrameTables {
  ScatteringTable scattering;
  SpeckleField speckle;
  SubColumnBins sub_columns;

  std::vector<double> path_power;  ///< [n_range] what the atmosphere leaves; empty: all

  explicit FrameTables(const FramePlan& plan);
};

/// The wedge that a thread has in hand, and its buffers, reused from wedge to wedge.
struct WedgeWork {
  const FramePlan& plan;
  const FrameTables& tables;
  EchoBins echo;
  EchoCells cells;
  SampleBatch samples;
  std::unique_ptr<SampleSource> source;  ///< of samples, or
  std::unique_ptr<SweepEchoes> sweep;    ///< of echoes; both null: no wedge in hand
  std::optional<WedgeVisibility> visibility;
  std::unique_ptr<EchoSums> sums;  ///< of a frame that is made from sharp wedges, when the first are there
  Wedge wedge;

  WedgeWork(const FramePlan& frame_plan, const FrameTables& frame_tables, const RenderOptions& options)
      : plan(frame_plan),
        tables(frame_tables),
        echo(plan, tables.scattering, tables.speckle, {}, options.surfaces),
        cells(plan, tables.scattering, tables.speckle, options.surfaces, options.iq) {}

  bool begun() const { return source || sweep; }
};

/// Lit and unsampled bins of a wedge, by its states.
void count_states(Wedge& wedge);
/// Ground area of a wedge's azimuth bins, added to its counts.
void measure_coverage(const FramePlan& plan, Wedge& wedge);

/// Takes wedge `index` in hand. Its bins beyond far_m may stay dark.
void begin_wedge(WedgeWork& work, int index, double far_m, HitObserver* observer);

/// The pipeline, without the area (measure_coverage). True: work.wedge is finished. False: may_go_on() said
/// no after a batch, and the next call goes on from there.
bool render_wedge(WedgeWork& work, bool states, const std::function<bool()>& may_go_on);

}  // namespace obliq
