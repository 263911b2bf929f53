#include "server/scene/embree_tracer.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "server/scene/tile_bounds.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq {
namespace {

constexpr unsigned kGroundGeometry = 0;
constexpr unsigned kBuildingGeometry = 1;

/// Embree wants denormals off while it traces; the rest of the program keeps IEEE arithmetic.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }  // FTZ | DAZ
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

/// Tells Embree that a packet's rays go the same way; versions 3 and 4 hear it differently.
class CoherentRays {
 public:
#if RTC_VERSION_MAJOR >= 4
  CoherentRays() {
    rtcInitIntersectArguments(&arguments_);
    arguments_.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  }
  void intersect(const int* valid, RTCScene scene, RTCRayHit16& packet) {
    rtcIntersect16(valid, scene, &packet, &arguments_);
  }

 private:
  RTCIntersectArguments arguments_;
#else
  CoherentRays() {
    rtcInitIntersectContext(&context_);
    context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }
  void intersect(const int* valid, RTCScene scene, RTCRayHit16& packet) {
    rtcIntersect16(valid, scene, &context_, &packet);
  }

 private:
  RTCIntersectContext context_;
#endif
};

/// A direction's component as Embree gets it. Embree 3.13 divides by +1e-18 instead of anything smaller,
/// whatever its sign, but sorts a packet's rays by the sign itself: with one component between -1e-18 and 0
/// among rays of other directions, as the cosine of 90 degrees makes them, two rays of three miss everything
/// (tests/edge_cases/grazing_test.cpp). At 500 km what is cut off here is half a nanometre, and hits are
/// intersected again with the true direction.
float component(double value) {
  constexpr double kLeast = 1e-15;
  return std::abs(value) < kLeast ? 0.0f : static_cast<float>(value);
}

}  // namespace

struct EmbreeTracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  BuildingMesh mesh;
  std::atomic<std::int64_t> bytes{0};
  std::atomic<std::int64_t> peak_bytes{0};
  double build_s = 0;
  std::mutex progress_mutex;
  double progress_shown = 0;
  Progress progress;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) {
      rtcSetDeviceMemoryMonitorFunction(device, nullptr, nullptr);
      rtcReleaseDevice(device);
    }
  }

  void check(const char* doing) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw InputError(std::string("Embree: ") + doing + " failed (" +
                     (error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory" : "error " + std::to_string(error)) +
                     "); use a larger [terrain] cell_m or a smaller area");
  }

  static bool count_memory(void* self, ssize_t bytes, bool) {
    auto* impl = static_cast<Impl*>(self);
    const std::int64_t now = impl->bytes += bytes;
    std::int64_t peak = impl->peak_bytes;
    while (now > peak && !impl->peak_bytes.compare_exchange_weak(peak, now)) {
    }
    return true;
  }

  static bool show_progress(void* self, double fraction) {
    auto* impl = static_cast<Impl*>(self);
    const std::scoped_lock lock(impl->progress_mutex);
    if (impl->progress && fraction >= impl->progress_shown + 0.01) {
      impl->progress_shown = fraction;
      impl->progress("building ray-tracing scene", std::min(1.0, fraction));
    }
    return true;
  }

  std::int64_t mesh_bytes() const {
    return static_cast<std::int64_t>(mesh.vertices_m.capacity() * sizeof mesh.vertices_m[0] +
                                     mesh.triangles.capacity() * sizeof mesh.triangles[0] +
                                     mesh.triangle_face.capacity() * sizeof mesh.triangle_face[0]);
  }

  /// The number of a triangle among its face's, which follow each other.
  std::uint32_t number_in_face(std::uint32_t triangle) const {
    std::uint32_t number = 0;
    while (number < triangle && mesh.triangle_face[triangle - number - 1] == mesh.triangle_face[triangle])
      ++number;
    return number;
  }

  void add_ground(const HeightGrid& grid) {
    std::vector<RTCGrid> tiles;
    for (const GridTile& tile : known_tiles(grid))
      tiles.push_back({static_cast<unsigned>(tile.first_post), static_cast<unsigned>(grid.nx),
                       static_cast<unsigned short>(tile.posts_x), static_cast<unsigned short>(tile.posts_z)});
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_GRID);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), grid.y_m.size()));
    check("allocating terrain vertices");
    for (int j = 0; j < grid.nz; ++j) {
      const auto z = static_cast<float>(grid.node_z_m(j));
      for (int i = 0; i < grid.nx; ++i, vertices += 3) {
        vertices[0] = static_cast<float>(grid.node_x_m(i));
        vertices[1] = grid.y_m[grid.index(i, j)];
        vertices[2] = z;
      }
    }
    if (!tiles.empty()) {
      void* buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID,
                                             sizeof(RTCGrid), tiles.size());
      check("allocating terrain tiles");
      std::memcpy(buffer, tiles.data(), tiles.size() * sizeof(RTCGrid));
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(scene, geometry, kGroundGeometry);
    }
    rtcReleaseGeometry(geometry);
  }

  void add_buildings(const Buildings& buildings) {
    mesh = mesh_of(buildings);
    if (mesh.triangles.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices_m.data(),
                               0, sizeof mesh.vertices_m[0], mesh.vertices_m.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof mesh.triangles[0], mesh.triangles.size());
    check("placing buildings");
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, kBuildingGeometry);
    rtcReleaseGeometry(geometry);
  }
};

EmbreeTracer::EmbreeTracer(const World& world, int threads, const Progress& progress, TracerIsa isa)
    : impl_(std::make_unique<Impl>()) {
  const auto start = std::chrono::steady_clock::now();
  const unsigned n = threads > 0 ? static_cast<unsigned>(threads) : std::thread::hardware_concurrency();
  if (!has_isa(isa)) throw InputError(std::string("Embree: this processor has no ") + isa_name(isa));
  std::string config = "threads=" + std::to_string(n);
  if (isa != TracerIsa::best) config += std::string(",isa=") + isa_name(isa);
  impl_->device = rtcNewDevice(config.c_str());
  if (!impl_->device) throw InputError("Embree: cannot create a device on this machine");
  rtcSetDeviceMemoryMonitorFunction(impl_->device, Impl::count_memory, impl_.get());
  impl_->scene = rtcNewScene(impl_->device);
  // COMPACT: 27 bytes a post instead of 34, as fast, and quicker to build.
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
  impl_->progress = progress;
  rtcSetSceneProgressMonitorFunction(impl_->scene, Impl::show_progress, impl_.get());
  impl_->add_ground(world.grid);
  impl_->add_buildings(world.buildings);
  rtcCommitScene(impl_->scene);
  impl_->check("building the scene");
  rtcSetSceneProgressMonitorFunction(impl_->scene, nullptr, nullptr);
  impl_->progress = {};
  impl_->build_s = seconds_since(start);
}

EmbreeTracer::~EmbreeTracer() = default;

void EmbreeTracer::trace(const glm::dvec3& origin_m, const double* dir_x, const double* dir_y,
                         const double* dir_z, int n, RoughHit* hits, const std::uint16_t* order) const {
  const auto ray_at = [order](int k) { return order ? static_cast<int>(order[k]) : k; };
  const FlushDenormals flush;
  CoherentRays coherent;
  RTCRayHit16 packet;
  alignas(64) int valid[kPacket];
  for (int lane = 0; lane < kPacket; ++lane) {  // what Embree leaves as it is
    packet.ray.org_x[lane] = static_cast<float>(origin_m.x);
    packet.ray.org_y[lane] = static_cast<float>(origin_m.y);
    packet.ray.org_z[lane] = static_cast<float>(origin_m.z);
    packet.ray.tnear[lane] = 0;
    packet.ray.time[lane] = 0;
    packet.ray.mask[lane] = ~0u;
    packet.ray.id[lane] = 0;
    packet.ray.flags[lane] = 0;
  }
  for (int first = 0; first < n; first += kPacket) {
    const int used = std::min(kPacket, n - first);
    for (int lane = 0; lane < kPacket; ++lane) {
      const int ray = ray_at(first + std::min(lane, used - 1));
      valid[lane] = lane < used ? -1 : 0;
      packet.ray.dir_x[lane] = component(dir_x[ray]);
      packet.ray.dir_y[lane] = component(dir_y[ray]);
      packet.ray.dir_z[lane] = component(dir_z[ray]);
      packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    coherent.intersect(valid, impl_->scene, packet);
    for (int lane = 0; lane < used; ++lane) {
      RoughHit& hit = hits[ray_at(first + lane)];
      const unsigned geometry = packet.hit.geomID[lane];
      hit.distance_m = packet.ray.tfar[lane];
      hit.kind = geometry == RTC_INVALID_GEOMETRY_ID ? RoughHit::Kind::none
                 : geometry == kGroundGeometry       ? RoughHit::Kind::ground
                                                     : RoughHit::Kind::building;
      if (hit.kind != RoughHit::Kind::building) continue;
      hit.face = impl_->mesh.triangle_face[packet.hit.primID[lane]];
      hit.triangle = impl_->number_in_face(packet.hit.primID[lane]);
    }
  }
}

std::uint64_t EmbreeTracer::bytes() const {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, impl_->bytes.load() + impl_->mesh_bytes()));
}

std::uint64_t EmbreeTracer::peak_bytes() const {
  return static_cast<std::uint64_t>(
      std::max<std::int64_t>(0, impl_->peak_bytes.load() + impl_->mesh_bytes()));
}

double EmbreeTracer::build_s() const { return impl_->build_s; }

std::string EmbreeTracer::version() { return "Embree " RTC_VERSION_STRING; }

bool has_isa(TracerIsa isa) {
  switch (isa) {
    case TracerIsa::sse42:
      return __builtin_cpu_supports("sse4.2") != 0;
    case TracerIsa::avx:
      return __builtin_cpu_supports("avx") != 0;
    case TracerIsa::avx2:  // Embree's set includes fused multiply-add and the bit manipulations
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
             __builtin_cpu_supports("bmi2") != 0;
    case TracerIsa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
             __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512vl") != 0;
    case TracerIsa::best:
      break;
  }
  return true;
}

}  // namespace obliq
