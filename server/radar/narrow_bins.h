#pragma once
// Azimuth bins of the sweep wider than half a degree are looked at as several narrower ones, each with
// scatterers of its own, and added up by the thread that looks at them, one narrow wedge after the other:
// memory does not grow with a bin's width.
#include "server/radar/bins.h"
#include "server/radar/settings.h"

namespace obliq {

/// Narrow bins that make up one of these settings; 1: it is not divided. Cameras keep their bins, and so do
/// exact planes (sub_columns = 0), whose strands follow buildings however wide a bin is.
int narrow_bins(const RadarSettings& settings);

/// The frame that is looked at: as many planes a bin as the settings ask for, shared among its narrow ones,
/// and one in each of these at least.
RadarSettings narrow_frame(RadarSettings settings);

/// Adds neighbouring narrow bins to those that n of them make up each, which get theirs from left to right.
/// A mean elevation is there where theirs is, and what labels are made of.
void add_narrow(const BinBlock& narrow, int n, BinBlock& bins);

}  // namespace obliq
