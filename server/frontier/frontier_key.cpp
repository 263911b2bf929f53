#include <fmt/core.h>

#include <array>

#include "server/control/scene_file.h"
#include "server/frontier/frontier_run.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

template <class List>
std::uint64_t hash_list(std::uint64_t hash, const List& list) {
  return checksum(list.data(), list.size() * sizeof list[0], hash);
}

/// Everything that the truth depends on besides its sampling.
std::uint64_t world_hash(const World& world, std::uint64_t hash) {
  hash = hash_list(hash, world.grid.y_m);
  hash = hash_list(hash, world.surface_material);
  if (!world.raster_gamma.empty()) hash = hash_list(hash, world.raster_gamma);
  hash = hash_list(hash, world.buildings.ring_xz_m);
  for (const Building& building : world.buildings.list)
    hash = hash_list(hash, std::array{building.roof_y_m, building.base_y_m});
  return hash;
}

/// The scene without what changes no line of the table: the cases set pixels, kind and plates themselves.
SceneConfig what_counts(SceneConfig config) {
  config.server = {};
  config.accuracy = {};
  for (RadarConfig& radar : config.radars) radar.settings = with_sampling(radar.settings, paper_sampling(0));
  return config;
}

}  // namespace

std::uint64_t frontier_key(const SceneConfig& config, const std::string& radar,
                           const FrontierOptions& options, const FrontierHeader& header,
                           const std::vector<SamplingCase>& cases, const World& world) {
  std::string text = print_config(what_counts(config)) + header.version + header.cpu + header.tracer;
  for (const SamplingCase& c : cases) text += fmt::format("{} {}\n", sampling_text(c), c.cell_m);
  for (const double number : {1.0 * header.threads, 1.0 * options.repeats, 1.0 * header.azimuths_compared,
                              1.0 * options.truth_planes, options.truth_step_m,
                              1.0 * options.most_truth_planes, 1.0 * static_cast<int>(options.against)})
    text += fmt::format("{} ", number);
  return world_hash(world, hash_list(1, text + radar));
}

}  // namespace obliq
