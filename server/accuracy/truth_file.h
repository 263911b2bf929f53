#pragma once
// Truth that outlives an interrupted run: each stretch of azimuths is appended to a file as it is done.
#include <cstdint>
#include <filesystem>

#include "server/accuracy/truth_bins.h"

namespace obliq {

/// Integrates the truth of every run, in stretches of one wedge; what the file holds already is taken from
/// there. `key` names everything that the truth depends on: a file of another key is replaced. A stretch that
/// was cut off or damaged, and all behind it, is integrated again. Throws InputError when it cannot be
/// written.
TruthBins integrate_truth_in_file(const std::filesystem::path& path, std::uint64_t key, const FramePlan& plan,
                                  const AzimuthRuns& runs, const ReferenceSampling& sampling,
                                  const Progress& progress = {});

}  // namespace obliq
