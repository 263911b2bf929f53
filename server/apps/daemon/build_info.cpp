#include "server/apps/daemon/build_info.h"

#include "server/scene/embree_tracer.h"
#include "terrain/library_versions.h"

namespace obliq {

http::BuildInfo build_info() {
  http::BuildInfo build;
  build.version = OBLIQ_VERSION;
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
