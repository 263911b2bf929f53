#pragma once
// What a wall and level or tilted ground before it return together, by another way than the project's: the
// antenna's image in the wall, a two-dimensional integral over the wall, each ray's own directions. Shares no
// code with the pipeline.
#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <numbers>

namespace obliq::test {

struct CornerOracle {
  glm::dvec3 antenna_m;
  glm::dvec3 left_m, right_m;  ///< ends of the wall's foot line, as seen from outside; y is not used
  double roof_y_m;
  double y0_m, per_x, per_z;  ///< the ground: y = y0 + per_x x + per_z z
  std::complex<double> wall_permittivity, ground_permittivity;
  double rms_slope;
  bool vertical;

  double ground_y(double x, double z) const { return y0_m + per_x * x + per_z * z; }

  double reflected(std::complex<double> eps, double c) const {
    const std::complex<double> root = std::sqrt(eps - 1.0 + c * c);
    const std::complex<double> r = vertical ? (eps * c - root) / (eps * c + root) : (c - root) / (c + root);
    return std::norm(r);
  }

  /// Sum of sigma / (r1 r2)^2 by half the path, in bins of bin_m. steps: of the wall, each way.
  std::map<int, double> power(double bin_m, int steps = 400) const {
    std::map<int, double> bins;
    const glm::dvec3 ground_normal = glm::normalize(glm::dvec3(-per_x, 1, -per_z));
    glm::dvec3 u = right_m - left_m;
    u.y = 0;
    const double length_m = glm::length(u);
    u /= length_m;
    glm::dvec3 w(-u.z, 0, u.x);
    glm::dvec3 to_antenna = antenna_m - left_m;
    if (glm::dot(w, to_antenna) < 0) w = -w;
    const double behind_m = glm::dot(w, to_antenna);
    const glm::dvec3 image_m = antenna_m - 2 * behind_m * w;
    for (int i = 0; i < steps; ++i) {
      // A ray from the image leaves the wall over this place of its foot, at x before the wall it is wider.
      const glm::dvec3 at_wall = left_m + u * ((i + 0.5) / steps * length_m);
      const auto place = [&](double x) {
        glm::dvec3 p = image_m + (at_wall - image_m) * ((behind_m + x) / behind_m);
        p.y = ground_y(p.x, p.z);
        return p;
      };
      const auto on_wall_y = [&](double x) {
        return image_m.y + (place(x).y - image_m.y) * behind_m / (behind_m + x);
      };
      double low = 0, high = behind_m;
      for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (on_wall_y(middle) <= roof_y_m ? low : high) = middle;
      }
      for (int j = 0; j < steps; ++j) {
        const double x = (j + 0.5) / steps * low;
        const glm::dvec3 p = place(x);
        const double area = length_m / steps * (behind_m + x) / behind_m * low / steps / ground_normal.y;
        const double r1 = glm::length(p - antenna_m), r2 = glm::length(p - image_m);
        const glm::dvec3 in = (p - antenna_m) / r1, out = (image_m - p) / r2;
        // Outwards along the mirrored ray: from the ground to the image.
        const glm::dvec3 q = out - in;
        const double q_length = glm::length(q);
        const double cosine = glm::dot(q, ground_normal) / q_length;
        if (cosine <= 0) continue;
        const double tan2 = 1 / (cosine * cosine) - 1;
        const double density =
            std::exp(-tan2 / (2 * rms_slope * rms_slope)) / (2 * std::numbers::pi * rms_slope * rms_slope);
        const double sigma0 = reflected(ground_permittivity, -glm::dot(in, q) / q_length) * std::numbers::pi *
                              density / std::pow(cosine, 4);
        const double sigma = 4 * reflected(wall_permittivity, std::abs(glm::dot(out, w))) * sigma0 * area;
        bins[static_cast<int>((r1 + r2) / 2 / bin_m)] += sigma / (r1 * r1 * r2 * r2);
      }
    }
    return bins;
  }

  double total(int steps = 400) const {
    double sum = 0;
    for (const auto& [bin, power_m2] : power(1e6, steps)) sum += power_m2;
    return sum;
  }
};

}  // namespace obliq::test
