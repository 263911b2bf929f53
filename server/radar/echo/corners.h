#pragma once
// Corners of wall and ground: a wall square to the line of sight and the ground before it throw the wave
// back.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include "server/radar/receiver_settings.h"
#include "server/scene/materials.h"

namespace obliq {

/// Power reflectivity |R|^2 of a smooth half space (Fresnel; Ulaby & Long 2014, section 2-7). permittivity:
/// relative, eps' - j eps''. Horizontal: the electric field lies square to the plane of incidence.
double fresnel_reflectivity(std::complex<double> permittivity, double cos_incidence,
                            Polarisation polarisation);

/// The direction to the antenna, -k, at a wall's foot: parts of a unit vector along the wall's horizontal
/// normal w, along the wall, u, and upwards. w, u and up are left-handed: u = (w_z, -w_x) in world (x, z).
struct CornerSight {
  double across;  ///< -k . w: cosine of the incidence on the wall
  double along;   ///< -k . u
  double up;
  /// q . w, of ground before the foot: nearer to the antenna than to its image. 0 far away.
  double lean = 0;

  /// Of ground `before` of the foot's distance in front of it, which the antenna's image lights over the
  /// wall; level: cosine of the foot's depression; down_there: tangent of that ground's, seen from the foot's
  /// distance.
  static CornerSight over_ground(double across, double along, double level, double before,
                                 double down_there) {
    const double up = down_there * level;
    return {across * level, along * level * (1 + before), up, -across * level * before * up * up};
  }
};

/// The ground before the wall: its rise for a metre along w and along u.
struct FootSlope {
  double across = 0;
  double along = 0;
};

/// What corners return, by materials (client/guide/model.md, "Corners of walls and ground"). Immutable.
///
/// The wall mirrors the antenna; ground before it scatters the wave into the mirror's direction by geometric
/// optics (Barrick 1968: sigma0 = |Rg|^2 pi (q / q_n)^4 p(slopes), p Gaussian, at the bistatic vector
/// q = k_mirrored - k, here twice the part of -k square to w). Wall first and ground first are the same path
/// walked both ways: fields add, power is fourfold. So
///   sigma = 4 |Rw|^2 |Rg|^2 A (1 + t^2)^2 exp(-t^2 / 2 s^2) / (2 s^2),
/// t the tangent of the angle between q and the ground's normal, A the area of the ground that takes part,
/// s the ground's rms slope. Franceschetti, Iodice, Riccio, IEEE TGRS 40(8), 2002 have the same two bounces
/// with their own closed form. Holds for ground that is rough for the wavelength and has s >= kLeastSlope.
/// Both bounces lie in the plane of k and w; that it is turned about k away from the vertical, which mixes
/// polarisations off the lobe's middle, is left out.
class CornerTable {
 public:
  /// Smoother ground has a lobe narrower than this and a brighter flash: it is taken for this.
  static constexpr double kLeastSlope = 0.02;

  CornerTable(const std::vector<Material>& materials, Polarisation polarisation);

  /// The part of sigma / A that depends on slopes: (1 + t^2)^2 exp(-t^2 / 2 s^2) / (2 s^2); 0 below 0.0025 of
  /// its peak, and where the ground shows its back.
  double lobe(std::uint8_t ground, const CornerSight& sight, const FootSlope& slope) const {
    // q . n, times n's length.
    const double along_normal = sight.up - slope.along * sight.along - slope.across * sight.lean;
    if (!(along_normal > 0)) return 0;
    const double length2 = 1 + slope.across * slope.across + slope.along * slope.along;
    const double q2 = sight.along * sight.along + sight.up * sight.up + sight.lean * sight.lean;
    const Row& row = rows_[ground];
    const double normal2 = along_normal * along_normal;
    if (!(q2 * length2 < row.edge2 * normal2)) return 0;
    return lobe_at(std::max(0.0, q2 * length2 / normal2 - 1), row.over_two_slope2);
  }
  /// The other: 4 |Rw|^2 |Rg|^2. across: CornerSight's.
  double reflectivity(std::uint8_t wall, std::uint8_t ground, double across) const;

  /// A lobe shines, on ground of any material that slopes by no more than kSteepest, up to this tangent of
  /// along / up.
  double greatest_along() const { return greatest_along_; }
  double narrowest_slope() const { return least_slope_; }

 private:
  static constexpr double kSteepest = 0.2;
  static double lobe_at(double tan2, double over_two_slope2);
  struct Row {
    double over_two_slope2;
    double edge2;  ///< 1 / cos^2 of the angle off the ground's normal where the lobe ends
    std::complex<double> permittivity;
  };
  std::vector<Row> rows_;
  Polarisation polarisation_;
  double least_slope_;  // of the materials in use
  double greatest_along_;
};

}  // namespace obliq
