#pragma once
#include <vector>

#include "server/radar/settings.h"

namespace obliq {

/// How the receiver colours its noise in range: filters of independent white noises whose outputs add up to
/// noise of mean square 1. Without a pulse {{1}}. Behind the matched filter of a rectangular pulse its
/// autocorrelation is the triangle of the pulse itself, exactly at whole bins; behind a compressed one that
/// of the point response, p * p.
std::vector<std::vector<double>> noise_kernels(const RadarSettings& settings);

}  // namespace obliq
