#pragma once
#include <complex>
#include <vector>

#include "server/radar/beam/row_places.h"
#include "server/radar/beam/sharp_wedge.h"

namespace obliq {

/// Power of materials in a row, of each `share` of theirs. kinds: sorted, not empty.
void power_of_materials(const SharpWedge& wedge, int azimuth, const std::vector<int>& kinds, float share,
                        std::vector<float>& power);

/// The sea in a row of sharp bins, which has a Doppler of its own (DopplerPlan::sea), and the rest.
struct SeaPart {
  // [stride]
  std::vector<float> power;  ///< the sea's
  RowPlaces places;
  std::vector<float> rest_power;  ///< what is left
  // [stride][2], as `split` leaves them: voltages in proportion to the powers' roots. Where a bin has both,
  // `split` turns the sea's phase by quarters that are hashed: sea and land are two scatterers.
  std::vector<float> iq, rest_iq;
  std::vector<float> re, im;  ///< the sea's again

  void place(const EchoPlan& plan, const SharpWedge& wedge, int azimuth);
  /// key: names the draw of drawn voltages; else 0.
  void split(const EchoPlan& plan, int azimuth, std::uint64_t key, const float* whole_iq,
             const float* whole_power);
};

}  // namespace obliq
