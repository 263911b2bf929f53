#pragma once
// The only header that stands for Embree; embree_tracer.cpp is the only file that includes it.
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>

#include "server/scene/tracer_isa.h"
#include "terrain/base/parallel.h"
#include "terrain/world.h"

namespace obliq {

/// What a ray met first, as Embree saw it. The distance is float32 and only a first guess:
/// exact_hit.h turns it into a double range.
struct RoughHit {
  enum class Kind : std::uint8_t { none, ground, building };
  float distance_m = 0;          ///< along the unit direction
  std::uint32_t face = kNoFace;  ///< of a building, when kind is building
  std::uint32_t triangle = 0;    ///< among the face's (terrain/buildings/building_mesh.h)
  Kind kind = Kind::none;
};

/// Terrain as one GRID geometry, buildings as one TRIANGLE geometry, in a ROBUST and COMPACT scene.
/// Immutable; trace() is safe from any thread. The world has to outlive it.
class EmbreeTracer {
 public:
  static constexpr int kPacket = 16;

  /// Throws InputError when Embree cannot build the scene (out of memory), or when this machine lacks the
  /// instruction set.
  EmbreeTracer(const World& world, int threads, const Progress& progress, TracerIsa isa = TracerIsa::best);
  ~EmbreeTracer();
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  /// Traces n rays from one origin, in packets of 16, from distance 0 on. directions: unit vectors as three
  /// arrays [n]; hits[n] is filled. order[n]: which rays come together in packets, every one once; null: as
  /// they are.
  void trace(const glm::dvec3& origin_m, const double* dir_x, const double* dir_y, const double* dir_z, int n,
             RoughHit* hits, const std::uint16_t* order = nullptr) const;

  std::uint64_t bytes() const;       ///< what Embree holds for the scene, and the buildings' triangles
  std::uint64_t peak_bytes() const;  ///< the most that it held while it built
  double build_s() const;
  static std::string version();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace obliq
