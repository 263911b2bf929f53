#pragma once
#include "server/radar/settings.h"

namespace obliq {

/// Sharp bins a bin: a sum over bins stands for a sum over the ground in them only while a beamwidth has two
/// of them, and a range bin is no longer than the pulse resolves (the sampling theorem for g^2 and p^2).
constexpr int kMostSubBins = 8;
/// across_m_s: of the antenna, at most, across its lines of sight: Doppler wants more (rows_a_beamwidth).
int azimuth_sub_bins(const RadarSettings& settings, double across_m_s = 0);
int range_sub_bins(const RadarSettings& settings);

/// The narrowest feature of the azimuth pattern: of a file, the width of the box that sees as much ground.
double narrowest_beam_rad(const RadarSettings& settings);
/// That, or without a beam the width of an azimuth bin.
double azimuth_resolution_rad(const RadarSettings& settings);

}  // namespace obliq
