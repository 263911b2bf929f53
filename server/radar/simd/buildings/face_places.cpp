// Where on a wall or roof the pieces lie that sub-columns saw: by range and bearing.
#include "server/radar/simd/buildings/face_places.h"

namespace obliq::OBLIQ_ISA {
namespace {

OBLIQ_INLINE f64x8 doubles_at(const float* from) { return converted<double>(load_as<f32x8>(from)); }

/// In a face's plane: how far ahead and above the antenna, and how far off the plane passes the antenna.
struct OnPlane {
  f64x8 ahead, height, off;
};

OBLIQ_INLINE OnPlane on_roof(f64x8 roof, f64x8 range2, f64x8 secant2) {
  return {sqrt(max(f64x8{}, range2 - roof * roof) / secant2), roof, max(roof, -roof)};
}

OBLIQ_INLINE OnPlane on_wall(const FacePieces& pieces, int k, f64x8 roof, f64x8 tangent, f64x8 range2,
                             f64x8 secant2) {
  const f64x8 right0 = doubles_at(pieces.right0_m + k);
  const f64x8 ahead0 = doubles_at(pieces.ahead0_m + k);
  const f64x8 dr = doubles_at(pieces.right1_m + k) - right0;
  const f64x8 da = doubles_at(pieces.ahead1_m + k) - ahead0;
  const f64x8 cross = ahead0 * dr - right0 * da;
  const f64x8 nearest = min(ahead0, ahead0 + da);
  const f64x8 ahead = clamp(cross / (dr - tangent * da), nearest, nearest + max(da, -da));
  const f64x8 up = sqrt(max(f64x8{}, range2 - ahead * ahead * secant2));
  const f64x8 height = min(select(-up >= doubles_at(pieces.base_m + k), -up, up), roof);
  return {ahead, height, cross / sqrt(dr * dr + da * da)};
}

}  // namespace

void face_places(const BinAxes& bin, FacePieces& pieces) {
  for (int k = 0; k < pieces.n; k += kLanes) {
    const f64x8 range = doubles_at(pieces.range_m + k);
    const f64x8 tangent = doubles_at(pieces.tangent_sr + k) / doubles_at(pieces.solid_angle_sr + k);
    const f64x8 secant2 = 1.0 + tangent * tangent;
    const f64x8 roof = doubles_at(pieces.roof_m + k);
    const OnPlane roofs = on_roof(roof, range * range, secant2);
    const OnPlane walls = on_wall(pieces, k, roof, tangent, range * range, secant2);
    const mask8 is_roof = doubles_at(pieces.ahead0_m + k) == 0.0;
    const f64x8 ahead = select(is_roof, roofs.ahead, walls.ahead);
    const f64x8 off = select(is_roof, roofs.off, walls.off);
    const f64x8 middle = doubles_at(pieces.middle_m + k);
    store(pieces.sec2 + k, max(broadcast(1), middle * middle / max(off * off, broadcast(1e-6))));
    const f64x8 right = ahead * tangent;
    store(pieces.x_m + k, bin.antenna_x_m + ahead * bin.bearing.sin + right * bin.bearing.cos);
    store(pieces.y_m + k, bin.antenna_y_m + select(is_roof, roofs.height, walls.height));
    store(pieces.z_m + k, bin.antenna_z_m + ahead * bin.bearing.cos - right * bin.bearing.sin);
  }
}

}  // namespace obliq::OBLIQ_ISA
