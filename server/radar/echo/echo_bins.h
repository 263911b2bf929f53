#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/echo/bin_sums.h"
#include "server/radar/echo/datum_surface.h"
#include "server/radar/echo/foot_corner.h"
#include "server/radar/echo/scatterer_sums.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/samples.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/ground/sea_texture.h"

namespace obliq {

/// Adds up one wedge's samples. Those of one scatterer and bin are added before the speckle.
class EchoBins {
 public:
  EchoBins(const ScenePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
           AzimuthRange range, Surfaces surfaces = Surfaces::all, LabelParts labels = LabelParts::none);

  /// Empties the bins for another wedge and keeps their memory.
  void restart(AzimuthRange range);

  /// Scatters and bins samples; returns how many fell into the range swath.
  std::uint64_t add(const SampleBatch& samples);

  /// Writes I&Q, power and count of all bins and the state of the sampled ones. Add nothing after it before a
  /// restart.
  void write(BinBlock& block);

  /// What it takes at most.
  static std::int64_t bytes(const RadarSettings& settings);

 private:
  void add_corner(const SampleBatch& samples, std::size_t k);
  void add_speckle(std::size_t azimuth);
  void texture_samples(const SampleBatch& samples);

  const ScenePlan& plan_;
  const ScatteringTable& scattering_;
  const SpeckleField& speckle_;
  AzimuthRange range_;
  Surfaces surfaces_;
  bool has_raster_gamma_;
  double range_constant_;  // K of radar_equation
  BinSums bins_;
  DatumSurface datum_;  // of labels
  ScattererSums::Scratch scratch_;
  std::vector<ScattererSums> scatterers_;  // [range.count], ground speckle only
  SwathCells cells_;
  EchoFactors factors_;
  std::unique_ptr<SeaPieces> pieces_;  // where the sea has a texture
  BinnedSamples placed_;
  std::optional<FootCorner> foot_corner_;  // where corners are wanted
};

}  // namespace obliq
