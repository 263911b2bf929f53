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
#include "server/radar/wedge_sums.h"

namespace obliq {

/// What the wedges of a frame share besides the plan. Immutable.
struct FrameTables {
  ScatteringTable scattering;
  SpeckleField speckle;
  NearBuildings near_buildings;

  std::vector<double> path_power;  ///< [n_range] what the atmosphere leaves; empty: all

  explicit FrameTables(const ScenePlan& plan);
};

/// The work of a thread: a wedge and its buffers, reused from wedge to wedge.
struct WedgeWork {
  const ScenePlan& plan;
  const int narrow_bins;  ///< FramePlan's
  const FrameTables& tables;
  EchoBins echo;
  EchoCells cells;
  SampleBatch samples;
  std::unique_ptr<EchoSums> sums;  ///< over beam and pulse; null until there is something to add up
  Wedge wedge;

  WedgeWork(const FramePlan& frame, const FrameTables& frame_tables, Surfaces surfaces, bool iq,
            LabelParts labels)
      : plan(frame.looks_at()),
        narrow_bins(frame.narrow_bins()),
        tables(frame_tables),
        echo(plan, tables.scattering, tables.speckle, {}, surfaces, labels),
        cells(plan, tables.scattering, tables.speckle, surfaces, iq, labels) {}
};

/// Lit and unsampled bins of a wedge, by its states.
void count_states(Wedge& wedge);
/// Ground area of a wedge's azimuth bins, added to its counts.
void measure_coverage(const FramePlan& plan, Wedge& wedge);

/// Look and echoes: work.wedge becomes wedge `index`, as far as it is needed, without its area
/// (measure_coverage).
void render_wedge(WedgeWork& work, int index, const WedgeSums::Needed& needed);

}  // namespace obliq
