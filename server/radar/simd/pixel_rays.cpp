// Rays through the pixels of a perspective frustum, eight at a time.
#include "server/radar/simd/pixel_rays.h"

#include "server/radar/simd/lanes.h"

namespace obliq::OBLIQ_ISA {
int pixel_rays(const PixelCamera& camera, const PixelList& pixels, const PixelRays& rays) {
  const f64x8 numbers = lane_numbers<double, kLanes>();
  const f64x8 lowest = broadcast(-1);
  int n = 0;
  for (int k = 0; k < pixels.n; k += kLanes) {
    const f64x8 x = camera.left_m + (load(pixels.column + k) + 0.5) * camera.pixel_width_m;
    const f64x8 y = load(pixels.up_m + k);
    const f64x8 z = load(pixels.ahead_m + k);
    const f64x8 length2 = x * x + y * y + z * z;
    const f64x8 length = sqrt(length2);
    const f64x8 up = y / length;
    mask8 reached = camera.swath.reaches(up);
    if (camera.half_pixel_m > 0)
      reached |= camera.swath.reaches(max(lowest, y / (length + camera.half_pixel_m))) |
                 camera.swath.reaches(max(lowest, y / max(f64x8{}, length - camera.half_pixel_m)));
    const f64x8 number = numbers + static_cast<double>(k);
    const unsigned mask = movemask(reached & (number < static_cast<double>(pixels.n)));
    const f64x8 right = x / length;
    const f64x8 ahead = z / length;
    const f64x8 solid_angle = select(length2 < camera.wide_m2, broadcast(__builtin_nan("")),
                                     camera.solid_angle_m3 / (length2 * length));
    store(rays.dir_x + n, compress(mask, right * camera.cos_bearing + ahead * camera.sin_bearing));
    store(rays.dir_y + n, compress(mask, up));
    store(rays.dir_z + n, compress(mask, ahead * camera.cos_bearing - right * camera.sin_bearing));
    store(rays.solid_angle_sr + n, compress(mask, solid_angle));
    store_i32(rays.from + n, compress(mask, number));
    n += __builtin_popcount(mask);
  }
  return n;
}

}  // namespace obliq::OBLIQ_ISA
