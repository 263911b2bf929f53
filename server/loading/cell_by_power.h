#pragma once
#include "server/control/scene_config.h"
#include "terrain/base/parallel.h"
#include "terrain/world.h"

namespace obliq {

/// A scene's world. Cells that are "auto" over elevation models follow their heights (terrain/ground.cpp),
/// and then power: each radar that can be placed looks from its first pose at the ground without buildings,
/// as `draft` does with kJudgedBins x kJudgedBins bins. Where half the cell moves a total by more than
/// kMostPowerMove it is taken, twice at most, within terrain.most_auto_posts and server.max_memory_mb. What
/// was judged is a note in the report. threads: of the looks; 0: all cores. Throws as load_world() does.
World load_judged_world(const SceneConfig& config, int threads, const Progress& progress);

constexpr int kJudgedBins = 256;
constexpr double kMostPowerMove = 0.003;
constexpr int kMostHalvings = 2;

}  // namespace obliq
