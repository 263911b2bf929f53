#pragma once
#include <filesystem>
#include <memory>

#include "server/radar/samples.h"

namespace obliq {

/// Collects the paper's perspective projection textures while a frame is rendered, one value a pixel, and
/// writes them as one multi-channel OpenEXR. Row 0 is the far edge of the frustum.
///
/// Channels (float32 unless said): range_m and range_residual_m (their sum is the double range to 1e-9 m),
/// azimuth_rad (clockwise from the sector's centre), incidence_rad, normal.x/y/z and position.x/y/z in the
/// world frame, material (uint32; 4294967295 where no ray hit, and all other channels 0).
class SampleTextures : public HitObserver {
 public:
  SampleTextures(int columns, int rows);
  ~SampleTextures() override;

  void on_hit(std::uint32_t pixel, double azimuth_offset_rad, const ExactHit& hit) override;

  /// Throws InputError that names the file.
  void write(const std::filesystem::path& path) const;

 private:
  struct Planes;
  std::unique_ptr<Planes> planes_;
};

}  // namespace obliq
