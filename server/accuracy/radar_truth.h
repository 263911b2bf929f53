#pragma once
// The truth of bins behind a beam and a pulse.
#include "server/accuracy/truth_bins.h"

namespace obliq {

/// Sharp bins of the truth in an output bin, each way.
constexpr int kTruthParts = 8;

/// Integrates the reference on kTruthParts times as many azimuth and range bins, over a sector and a swath
/// that beam and pulse reach beyond the radar's own, and weighs what lies in each of them by the squared
/// two-way patterns g^2 and p^2 at its middle, in double: sum over (c) of P_c g^2(theta_c - theta_k)
/// p^2(r_c - r_m). Each facet has the g of its own elevation e, at the angle whose sine is
/// cos(e) sin(azimuth), however steep. Shares nothing with the pipeline but the patterns' formulas. Buildings
/// count as in the sharp bins. The sampling's planes are those of an output bin.
TruthBins integrate_radar_truth(const FramePlan& plan, const AzimuthRuns& runs,
                                const ReferenceSampling& sampling, const Progress& progress = {});

}  // namespace obliq
