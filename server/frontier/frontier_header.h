#pragma once
// frontier.json: which run a frontier.csv belongs to, and on what machine it was measured.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/accuracy/truth_search.h"

namespace obliq {

/// What frames are compared with: the reference renderer; or, where that would take hours, a frame of the
/// sweep with the reference quality's planes.
enum class Against { truth, reference };

struct FrontierHeader {
  std::string
      key;  ///< hash of scene, settings, options, machine and version: a run with another is another run
  std::string version;
  std::string scene;
  std::string radar;
  std::string view;  ///< one line: ranges, sector, bins
  std::string cpu;
  int threads = 0;
  std::string tracer;  ///< "Embree 3.13.5"
  int repeats = 0;
  int azimuth_bins = 0;
  int range_bins = 0;
  int azimuths_compared = 0;
  int buildings = 0;
  double scene_cell_m = 0;
  double truth_cell_m = 0;
  Against against = Against::truth;
  ReferenceSampling truth;  ///< Against::reference: planes alone
  std::vector<TruthCheck> truth_checks;
  int truth_check_azimuths = 0;
};

void write_frontier_header(const std::filesystem::path& path, const FrontierHeader& header);

/// Nothing when there is no such file. Throws InputError when it is no frontier's.
std::optional<FrontierHeader> read_frontier_header(const std::filesystem::path& path);

}  // namespace obliq
