#pragma once
#include <filesystem>
#include <string>

#include "server/accuracy/sampling_case.h"
#include "server/control/scene_config.h"
#include "server/frontier/frontier_table.h"
#include "terrain/world.h"

namespace obliq {

/// What `obliq frontier` was asked for, besides the scene.
struct FrontierOptions {
  std::string version;  ///< of the program
  std::string radar;
  std::filesystem::path out;
  FrontierRange range;  ///< cells_m: other than the scene's; empty: twice and four times it
  bool scene_cell_only = false;
  int azimuths = 0;  ///< compared with the truth; 0: all
  int threads = 0;
  int repeats = 3;
  Against against = Against::truth;
  int truth_planes = 32;  ///< to begin with
  double truth_step_m = 2;
  int most_truth_planes = 512;
  int stop_after = 0;    ///< samplings measured in this run; 0: all
  bool restart = false;  ///< drop what an earlier run left
};

/// Names everything that the lines of a frontier's table depend on: scene, samplings, options, machine and
/// version. A run with another key is another run. world: the truth's.
std::uint64_t frontier_key(const SceneConfig& config, const std::string& radar,
                           const FrontierOptions& options, const FrontierHeader& header,
                           const std::vector<SamplingCase>& cases, const World& world);

/// Measures every sampling that is not in the folder's table yet, and writes table, report and pictures. True
/// when all are measured, false after stop_after of them. Throws InputError.
bool run_frontier(const SceneConfig& config, const FrontierOptions& options);

}  // namespace obliq
