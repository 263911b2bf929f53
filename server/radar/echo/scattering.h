#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/radar/echo/corners.h"
#include "server/radar/simd/echoes/cross_section.h"
#include "server/scene/materials.h"

namespace obliq {

struct SeaTexture;  // server/radar/simd/ground/sea_texture.h

/// What water returns over its gamma in the pipeline (sea_over_gamma); null: nothing more.
struct SeaOfFrame {
  std::shared_ptr<const SeaTable> mean;
  std::shared_ptr<const SeaTexture> texture;
};

/// Radar cross section of the surface, one row per material with its constants worked out (PAPER.md,
/// eq. 12). Immutable.
///
/// Every model is written in the projected area A cos(theta) = solid_angle r^2, so that grazing stays finite:
///   constant gamma     sigma = gamma area
///   geometric optics   sigma = (R2 exp(-t^2 / 2 s^2) (1 + t^2)^(5/2) / (2 s^2) + gamma) area, t =
///   tan(theta);
///                      Ulaby & Long 2014, eq. 10-2 form for a Gaussian surface; the gamma floor keeps steep
///                      faces visible
///   flat plate         sigma = 4 pi tau(theta) area^2 / lambda^2, paper eq. (12) corrected
class ScatteringTable {
 public:
  /// corners: of walls with the ground before them; empty: they return nothing.
  ScatteringTable(const std::vector<Material>& materials, double wavelength_m,
                  std::optional<CornerTable> corners = {}, SeaOfFrame sea = {});

  /// sigma, square metres; of sea without its state. projected_area_m2 = solid angle x slant range^2;
  /// cos_incidence in 0..1.
  double cross_section_m2(std::uint8_t material, double projected_area_m2, double cos_incidence) const;

  std::size_t size() const { return rows_.size(); }
  /// Of a material whose cross section is that times the projected area, whatever the incidence; else NaN.
  double constant_gamma(std::size_t material) const;
  /// For the kernels: gamma, peak and slope by material. Flat plates are not in it.
  EchoTable echo_table() const;
  /// Null: none are wanted.
  const CornerTable* corners() const { return corners_ ? &*corners_ : nullptr; }
  /// Null: water is as its material.
  const SeaTable* sea() const { return sea_.mean.get(); }
  /// By which powers of pieces of the sea are multiplied; null: it is smooth.
  const SeaTexture* texture() const { return sea_.texture.get(); }

 private:
  struct Row {
    ScatteringModel model;
    double gamma;
    double peak;             // R2 / (2 s^2)
    double over_two_slope2;  // 1 / (2 s^2)
    double plate;            // 4 pi tau / lambda^2
    double plate_exponent;
  };
  std::vector<Row> rows_;
  std::optional<CornerTable> corners_;
  SeaOfFrame sea_;
};

}  // namespace obliq
