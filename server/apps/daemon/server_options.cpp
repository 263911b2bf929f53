#include "server/apps/daemon/server_options.h"

#include "server/apps/serving.h"
#include "server/apps/version/version.h"
#include "server/scene/embree_tracer.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq {

net::ServerOptions server_options(const SceneConfig& config) {
  net::ServerOptions options = serving_options(config);
  options.server_version = program_version();
  options.scene_name = config.name;
  options.render_threads = config.threads;
  options.target_types = config.target_types;
  options.targets = config.targets;
  options.target_seed = config.target_seed;
  options.materials = static_cast<int>(config.materials.size());
  return options;
}

http::BuildInfo build_info() {
  http::BuildInfo build;
  build.version = program_version();
#if defined(__clang__)
  build.compiler = "clang " __clang_version__;
#else
  build.compiler = "GCC " __VERSION__;
#endif
  build.embree = EmbreeTracer::version();
  build.gdal = gdal_version();
  return build;
}

}  // namespace obliq
