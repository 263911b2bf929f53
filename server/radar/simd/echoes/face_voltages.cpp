#include "server/radar/simd/echoes/face_voltages.h"

#include "server/radar/simd/echoes/bin_samples.h"
#include "server/radar/simd/echoes/cell_key.h"
#include "server/radar/simd/echoes/face_cell.h"
#include "server/radar/simd/lanes/float_math.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Scatterers of faces: where from the antenna their phase is taken, and what it is drawn from.
struct Scatterers {
  mask8 whole;  // or given
  f64x8 x, y, z;
  u64x8 hash;
};

/// SpeckleField::scatterer, reference_point and hash.
OBLIQ_INLINE Scatterers scatterers_of(const FaceBins& bins, const FaceEchoes& faces, int k) {
  const f64x8 centre_x = load(faces.centre_x_m + k);
  const f64x8 centre_y = load(faces.centre_y_m + k);
  const f64x8 centre_z = load(faces.centre_z_m + k);
  const u64x8 face_hash = load_u64(faces.hash + k);
  const mask8 given = load_u64(faces.given + k) != 0;
  const f64x8 cells_per_m = gather(bins.cells_per_m, to_u64(octave_of(load(faces.range_m + k))));
  const FaceCell<f64x8> cell = cell_on_face(load(faces.x_m + k) - centre_x, load(faces.y_m + k) - centre_y,
                                            load(faces.z_m + k) - centre_z, load(faces.reach_m + k),
                                            cells_per_m, load_u64(faces.wall + k) != 0);
  const mask8 whole = cell.whole | given;
  const f64x8 side = 1.0 / cells_per_m;
  const auto reference = [&](f64x8 centre, f64x8 number) __attribute__((always_inline)) {
    return select(whole, centre, centre + side * number);
  };
  const u64x8 of_cell =
      hash_of_face_cell(face_hash, place_on_face(to_i64(cell.x), to_i64(cell.y), to_i64(cell.z)),
                        level_in_kind(cells_per_m) | load_u64(faces.material + k));
  return {whole, reference(centre_x, cell.x) - bins.antenna_x_m,
          reference(centre_y, cell.y) - bins.antenna_y_m, reference(centre_z, cell.z) - bins.antenna_z_m,
          select(whole, face_hash, of_cell)};
}

}  // namespace

void face_powers(const EchoTable& table, FaceEchoes& faces) {
  for (int k = 0; k < faces.n; k += kLanes) {
    const f64x8 sec2 = load(faces.sec2 + k);
    const f64x8 range_m = load(faces.range_m + k);
    const f64x8 range2 = range_m * range_m;
    const f64x8 power = table.factor * load(faces.light + k);
    const f64x8 spread = table.range_normalisation ? range2 : 1.0 / range2;
    const f64x8 sigma = cross_section_of_area(table, load_u64(faces.material + k), sec2);
    store(faces.power_w + k, select(sec2 > 0.0, power * spread * sigma, power));
  }
}

void face_voltages(double wavelength_m, const FaceBins& bins, FaceEchoes& faces) {
  for (int k = 0; k < faces.n; k += kLanes) {
    const auto [whole, x, y, z, own_hash] = scatterers_of(bins, faces, k);
    const f64x8 range = sqrt(x * x + y * y + z * z);
    const u64x8 at_bin = load_u64(faces.at + k);
    const OwnerOffset<f64x8> off =
        owner_offset(bins.owners, x, z, range, to_doubles(at_bin >> 3), of_eight(bins.edges.sin, at_bin & 7),
                     of_eight(bins.edges.cos, at_bin & 7));
    u64x8 hash = own_hash;
    if (const mask8 far = off.is_far(); any(far)) hash = select(far, mix_words(hash ^ off.code()), hash);
    const f64x8 round_trips = 2.0 * range / wavelength_m;
    const f64x8 own_turns = turns_of_hash(hash) + select(off.is_far(), f64x8{}, off.turns(hash));
    const f64x8 turns = own_turns - (round_trips - floor(round_trips));
    const f64x8 modulus2 = select(whole, broadcast(1), modulus2_of_hash(hash));
    store_voltage(load(faces.power_w + k) * modulus2, turns, faces.re + k, faces.im + k);
  }
}

}  // namespace obliq::OBLIQ_ISA
