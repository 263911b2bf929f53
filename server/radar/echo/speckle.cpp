#include "server/radar/echo/speckle.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

/// Cells of 1 mm at least, so that cell numbers fit 32 bits within 2,000 km.
constexpr int kFinestLevel = -10;

/// 2^level.
double side_of(const Scatterer& s) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(s.level + 1023) << 52);
}

}  // namespace

SpeckleField::SpeckleField(const World& world, const glm::dvec3& antenna_m, double wavelength_m,
                           double range_spacing_m, double azimuth_width_rad, std::int64_t seed,
                           const OwnerBins& owners)
    : world_(world),
      antenna_m_(antenna_m),
      wavelength_m_(wavelength_m),
      seed_(mix64(static_cast<std::uint64_t>(seed))),
      owners_(owners) {
  for (int octave = 0; octave < 64; ++octave) {
    const double side = 0.5 * std::min(range_spacing_m, std::ldexp(azimuth_width_rad, octave));
    level_of_octave_[octave] = static_cast<std::int16_t>(std::clamp(std::ilogb(side), kFinestLevel, 20));
    cells_per_m_[octave] = std::ldexp(1.0, -level_of_octave_[octave]);
  }
}

Scatterer SpeckleField::scatterer(double slant_range_m, const glm::dvec3& at_m, std::uint32_t face,
                                  std::uint8_t material) const {
  if (face != kNoFace) return of_face(slant_range_m, at_m, world_.buildings.face(face), face, material);
  Scatterer s;
  s.material = material;
  const auto octave = static_cast<int>(octave_of(slant_range_m));
  s.level = level_of_octave_[octave];
  s.x_cell = static_cast<std::int32_t>(std::floor(at_m.x * cells_per_m_[octave]));
  s.z_cell = static_cast<std::int32_t>(std::floor(at_m.z * cells_per_m_[octave]));
  return s;
}

Scatterer SpeckleField::corner(double slant_range_m, const glm::dvec3& at_m, std::uint32_t face,
                               std::uint8_t material) const {
  return of_face(slant_range_m, at_m, world_.buildings.face(face), face, material, true);
}

Scatterer SpeckleField::of_face(double slant_range_m, const glm::dvec3& at_m, const BuildingFace& of,
                                std::uint32_t face, std::uint8_t material, bool corner) const {
  Scatterer s;
  s.material = material;
  s.face = face;
  s.corner = corner;
  const auto octave = static_cast<int>(octave_of(slant_range_m));
  const double cells_per_m = cells_per_m_[octave];
  const glm::dvec3 from_centre_m = at_m - of.centre_m;
  const FaceCell<double> cell = cell_on_face(from_centre_m.x, from_centre_m.y, from_centre_m.z, of.reach_m,
                                             cells_per_m, of.wall && !corner);
  s.level = cell.whole ? Scatterer::kWholeFace : level_of_octave_[octave];
  s.x_cell = static_cast<std::int32_t>(cell.x);
  s.y_cell = static_cast<std::int32_t>(cell.y);
  s.z_cell = static_cast<std::int32_t>(cell.z);
  return s;
}

/// A corner's lies on the ground, or, beside known ground, at the building's base: fixed in the world.
glm::dvec3 SpeckleField::reference_on(const BuildingFace& of, std::uint32_t building,
                                      const Scatterer& s) const {
  glm::dvec3 at_m = of.centre_m;
  if (s.level != Scatterer::kWholeFace) at_m += side_of(s) * glm::dvec3(s.x_cell, s.y_cell, s.z_cell);
  if (!s.corner) return at_m;
  at_m.y = world_.grid.height_at_m(at_m.x, at_m.z);
  if (std::isnan(at_m.y)) at_m.y = static_cast<double>(world_.buildings.list[building].base_y_m);
  return at_m;
}

SpeckleField::OnFace SpeckleField::on_corner(double slant_range_m, const glm::dvec3& at_m,
                                             std::uint32_t building, std::uint32_t face,
                                             std::uint8_t material) const {
  const BuildingFace of = world_.buildings.face(building, face);
  const Scatterer s = of_face(slant_range_m, at_m, of, face, material, true);
  return {reference_on(of, building, s), 0, hash_on(of.identity, s, 0), false};
}

std::uint64_t SpeckleField::hash(const Scatterer& s, std::uint64_t owner) const {
  if (s.face != kNoFace) return hash_on(world_.buildings.face(s.face).identity, s, owner);
  const ScattererKey key(s);
  return mix64(mix64(seed_ ^ key.place) ^ ((key.kind & 0xffffffffull) | owner));
}

std::uint64_t SpeckleField::hash_on(std::uint64_t identity, const Scatterer& s, std::uint64_t owner) const {
  const std::uint64_t of_face = mix64(seed_ ^ identity);
  if (s.level == Scatterer::kWholeFace) {
    const std::uint64_t other = owner | (s.corner ? ScattererKey::kCorner : 0);
    return other == 0 ? of_face : mix64(of_face ^ other);
  }
  const ScattererKey key(s);
  return hash_of_face_cell<std::uint64_t>(of_face, key.place, (key.kind & 0xffffffffull) | owner);
}

SpeckleField::Draw SpeckleField::draw(const Scatterer& s, const glm::dvec3& from_antenna,
                                      const OwnBin& bin) const {
  const bool quarter = owners_.quarter_turns && s.face != kNoFace;
  if (!quarter && !owners_.ground) return {hash(s), 0};
  const OwnerOffset<double> off =
      owner_offset(owners_, from_antenna.x, from_antenna.z, glm::length(from_antenna),
                   static_cast<double>(bin.range_bin), bin.left_edge.sin, bin.left_edge.cos);
  const auto code = static_cast<std::uint64_t>(off.code());
  if (!quarter) return {hash(s, code), 0};
  if (off.is_far()) return {mix64(hash(s) ^ code), 0};
  return {hash(s), off.turns(hash(s))};
}

glm::dvec3 SpeckleField::reference_point(const Scatterer& s) const {
  if (s.face != kNoFace)
    return reference_on(world_.buildings.face(s.face), world_.buildings.building_of_face[s.face], s);
  const double side = side_of(s);
  double x = (s.x_cell + 0.5) * side;
  double z = (s.z_cell + 0.5) * side;
  if (owners_.ground) {
    const std::uint64_t place_hash = mix64(ScattererKey(s).place ^ seed_);
    x += (jitter<double>(place_hash, 0) - 0.5) * side;
    z += (jitter<double>(place_hash, 16) - 0.5) * side;
  }
  const double y = world_.grid.height_at_m(x, z);
  // A cell whose centre has no ground (the edge of a void) takes the datum surface: fixed, like the rest.
  return {x, std::isnan(y) ? world_.frame.datum_y_m(x, z) : y, z};
}

std::complex<double> SpeckleField::response(const Scatterer& s, const OwnBin& bin) const {
  const glm::dvec3 from_antenna = reference_point(s) - antenna_m_;
  const double range_m = glm::length(from_antenna);
  const auto [h, off_turns] = draw(s, from_antenna, bin);
  const double own_turns = turns_of_hash(h) + off_turns;
  // Phase in turns, -4 pi r / lambda = -2 pi (2 r / lambda): reduced modulo one turn before any sine.
  const double round_trips = 2 * range_m / wavelength_m_;
  const SinCos at = sincos_turns(own_turns - (round_trips - std::floor(round_trips)));
  // Box and Muller 1958: |u|^2 = -ln(uniform) is exponential with mean 1.
  const double modulus =
      s.corner || s.level == Scatterer::kWholeFace ? 1.0 : std::sqrt(-log_of_positive(uniform_of_hash(h)));
  return {modulus * at.cos, modulus * at.sin};
}

void SpeckleField::respond(const SpeckleBlock& block) const {
  respond_ground(block);
  for (int k = 0; k < block.n; ++k)
    if (ScattererKey(block.place[k], block.kind[k]).face() != kNoFace) respond_alone(block, k);
}

void SpeckleField::respond_ground(const SpeckleBlock& block) const {
  if (active_kernels().ground_speckle({ground_view(world_.grid, antenna_m_), wavelength_m_, seed_, owners_},
                                      block))
    return;
  for (int k = 0; k < block.n; ++k)
    if (std::isnan(block.re[k])) respond_alone(block, k);
}

void SpeckleField::respond_alone(const SpeckleBlock& block, int k) const {
  OwnBin bin;
  if (block.at != nullptr) {
    const std::uint32_t azimuth = block.at[k] % 8;
    bin = {static_cast<int>(block.at[k] / 8), {block.edges->sin[azimuth], block.edges->cos[azimuth]}};
  }
  const ScattererKey key(block.place[k], block.kind[k]);
  const std::complex<double> voltage = std::sqrt(block.power_w[k]) * response(key.scatterer(), bin);
  block.re[k] = voltage.real();
  block.im[k] = voltage.imag();
}

void SpeckleField::describe_cells(SwathCells& cells) const {
  std::copy(std::begin(cells_per_m_), std::end(cells_per_m_), cells.cells_per_m);
}

}  // namespace obliq
