#include "server/radar/simd/echoes/face_voltages.h"

#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {

void face_voltages(const EchoTable& table, double wavelength_m, const FaceBins& bins, FaceEchoes& faces,
                   double* re, double* im) {
  for (int k = 0; k < faces.n; k += kLanes) {
    const f64x8 sec2 = load(faces.sec2 + k);
    const f64x8 power =
        load(faces.power_w + k) *
        select(sec2 > 0.0, cross_section_of_area(table, load_u64(faces.material + k), sec2), broadcast(1));
    store(faces.power_w + k, power);
    const f64x8 x = load(faces.x_m + k);
    const f64x8 y = load(faces.y_m + k);
    const f64x8 z = load(faces.z_m + k);
    const f64x8 range = sqrt(x * x + y * y + z * z);
    const u64x8 at_bin = load_u64(faces.at + k);
    const OwnerOffset<f64x8> off =
        owner_offset(bins.owners, x, z, range, to_doubles(at_bin >> 3), of_eight(bins.edges.sin, at_bin & 7),
                     of_eight(bins.edges.cos, at_bin & 7));
    u64x8 hash = load_u64(faces.hash + k);
    if (const mask8 far = off.is_far(); any(far)) hash = select(far, mix_words(hash ^ off.code()), hash);
    const f64x8 round_trips = 2.0 * range / wavelength_m;
    const f64x8 own_turns = turns_of_hash(hash) + select(off.is_far(), f64x8{}, off.turns(hash));
    const SinCosOf<f64x8> at = sincos_turns(own_turns - (round_trips - floor(round_trips)));
    const f64x8 modulus2 =
        select(load_u64(faces.whole + k) != 0, broadcast(1), -log_of_positive(uniform_of_hash(hash)));
    const f64x8 amplitude = sqrt(power) * sqrt(modulus2);
    store(re + k, amplitude * at.cos);
    store(im + k, amplitude * at.sin);
  }
}

}  // namespace obliq::OBLIQ_ISA
