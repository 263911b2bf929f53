// Rays through the pixels of a perspective frustum, eight at a time.
#include "server/radar/simd/pixel_rays.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// SwathTest::reaches.
OBLIQ_LANES LaneFlags reaches(const PixelCamera& camera, Lanes sine) {
  const LaneFlags below = sine < 0.0;
  const LaneFlags ground =
      (camera.below_bottom_m >= -sine * camera.r_min_m) & (camera.below_top_m <= -sine * camera.r_max_m);
  const LaneFlags above =
      (all_lanes(camera.below_top_m) <= 0.0) & (-camera.below_top_m >= sine * camera.r_min_m);
  return (below & ground) | (~below & above);
}

}  // namespace

int aim_pixels(const PixelCamera& camera, const PixelList& pixels, const AimedRays& rays) {
  const Lanes numbers = {0, 1, 2, 3, 4, 5, 6, 7};
  const Lanes lowest = all_lanes(-1);
  int n = 0;
  for (int k = 0; k < pixels.n; k += kLanes) {
    const Lanes x = camera.left_m + (load_lanes(pixels.column + k) + 0.5) * camera.pixel_width_m;
    const Lanes y = load_lanes(pixels.up_m + k);
    const Lanes z = load_lanes(pixels.ahead_m + k);
    const Lanes length2 = x * x + y * y + z * z;
    const Lanes length = sqrt_of(length2);
    const Lanes up = y / length;
    LaneFlags reached = reaches(camera, up);
    if (camera.half_pixel_m > 0)
      reached |= reaches(camera, greatest(lowest, y / (length + camera.half_pixel_m))) |
                 reaches(camera, greatest(lowest, y / greatest(Lanes{}, length - camera.half_pixel_m)));
    const Lanes number = numbers + static_cast<double>(k);
    const unsigned mask = mask_of(reached & (number < static_cast<double>(pixels.n)));
    const Lanes right = x / length;
    const Lanes ahead = z / length;
    const Lanes solid_angle = select(length2 < camera.wide_m2, all_lanes(__builtin_nan("")),
                                     camera.solid_angle_m3 / (length2 * length));
    store_lanes(rays.dir_x + n, compress(mask, right * camera.cos_bearing + ahead * camera.sin_bearing));
    store_lanes(rays.dir_y + n, compress(mask, up));
    store_lanes(rays.dir_z + n, compress(mask, ahead * camera.cos_bearing - right * camera.sin_bearing));
    store_lanes(rays.solid_angle_sr + n, compress(mask, solid_angle));
    store_ints(rays.from + n, compress(mask, number));
    n += __builtin_popcount(mask);
  }
  return n;
}

}  // namespace obliq::OBLIQ_ISA
