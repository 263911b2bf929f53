#pragma once
#include <filesystem>
#include <string>

#include "server/accuracy/sampling_case.h"
#include "server/control/scene_config.h"
#include "server/frontier/frontier_table.h"

namespace obliq {

/// What `obliq frontier` was asked for, besides the scene.
struct FrontierOptions {
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

/// Measures every sampling that is not in the folder's table yet, and writes table, report and pictures. True
/// when all are measured, false after stop_after of them. Throws InputError.
bool run_frontier(const SceneConfig& config, const FrontierOptions& options);

}  // namespace obliq
