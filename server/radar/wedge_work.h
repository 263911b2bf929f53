#pragma once
// A wedge on its way through the pipeline: what render_wedge (server/radar/render.cpp) works on.
#include <memory>
#include <vector>

#include "server/radar/beam/echo_sums.h"
#include "server/radar/echo/echo_bins.h"
#include "server/radar/echo/echo_cells.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/render.h"
#include "server/radar/sweep/sweep_echoes.h"

namespace obliq {

/// What the wedges of a frame share besides the plan. Immutable.
struct FrameTables {
  ScatteringTable scattering;
  SpeckleField speckle;
  SubColumnBins sub_columns;

  std::vector<double> path_power;  ///< [n_range] what the atmosphere leaves; empty: all

  explicit FrameTables(const FramePlan& plan);
};

/// What a thread has in hand: a wedge and its buffers, reused from wedge to wedge.
struct WedgeWork {
  const FramePlan& plan;
  const FrameTables& tables;
  EchoBins echo;
  EchoCells cells;
  SampleBatch samples;
  std::unique_ptr<EchoSums> sums;  ///< of a frame that is made from sharp wedges, when the first are there
  Wedge wedge;

  WedgeWork(const FramePlan& frame_plan, const FrameTables& frame_tables, const RenderOptions& options)
      : plan(frame_plan),
        tables(frame_tables),
        echo(plan, tables.scattering, tables.speckle, {}, options.surfaces),
        cells(plan, tables.scattering, tables.speckle, options.surfaces, options.iq) {}
};

/// Lit and unsampled bins of a wedge, by its states.
void count_states(Wedge& wedge);
/// Ground area of a wedge's azimuth bins, added to its counts.
void measure_coverage(const FramePlan& plan, Wedge& wedge);

/// The pipeline, without the area (measure_coverage): work.wedge is wedge `index`. Its bins beyond far_m may
/// stay dark. `observer` may be null.
void render_wedge(WedgeWork& work, int index, double far_m, bool states, HitObserver* observer);

}  // namespace obliq
