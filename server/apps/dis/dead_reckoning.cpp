#include "server/apps/dis/dead_reckoning.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace obliq {
namespace {

enum Algorithm { kFpw = 2, kRpw, kRvw, kFvw, kFpb, kRpb, kRvb, kFvb };

bool turns(int algorithm) {
  return algorithm == kRpw || algorithm == kRvw || algorithm == kRpb || algorithm == kRvb;
}
bool accelerates(int algorithm) {
  return algorithm == kRvw || algorithm == kFvw || algorithm == kRvb || algorithm == kFvb;
}
int algorithm_of(const EntityState& state) {
  return state.frozen || state.dead_reckoning < kFpw || state.dead_reckoning > kFvb ? 1
                                                                                    : state.dead_reckoning;
}

/// f[n] = sum over k of (-1)^k x^(2k) / (2k + n)!, n from 0 to 4: cos x, sin x / x, (1 - cos x) / x^2,
/// (x - sin x) / x^3, (x^2 / 2 - 1 + cos x) / x^4. By the series where the closed forms cancel.
std::array<double, 5> turn_integrals(double x) {
  std::array<double, 5> f{};
  const double square = x * x;
  if (square < 1) {
    double factorial = 1;
    for (std::size_t n = 0; n < f.size(); ++n) {
      if (n > 0) factorial *= static_cast<double>(n);
      double term = 1 / factorial;
      for (int k = 1; k <= 10; ++k) {  // the last is below 1e-18
        f[n] += term;
        const double m = 2 * k + static_cast<double>(n);
        term *= -square / (m * (m - 1));
      }
    }
    return f;
  }
  f[0] = std::cos(x);
  f[1] = std::sin(x) / x;
  f[2] = (1 - f[0]) / square;
  f[3] = (1 - f[1]) / square;
  f[4] = (0.5 - f[2]) / square;
  return f;
}

/// The integrals over t of R(t) v and of t R(t) a, R(t) by Rodrigues about w:
/// R(t) v = cos(wt) v + sin(wt)/w (w x v) + (1 - cos(wt))/w^2 w (w.v).
glm::dvec3 way_round(const glm::dvec3& v, const glm::dvec3& a, const glm::dvec3& w, double t) {
  const auto f = turn_integrals(glm::length(w) * t);
  const double t2 = t * t;
  return f[1] * t * v + f[2] * t2 * glm::cross(w, v) + f[3] * t2 * t * glm::dot(w, v) * w +
         (f[1] - f[2]) * t2 * a + (f[2] - f[3]) * t2 * t * glm::cross(w, a) +
         (f[3] - f[4]) * t2 * t2 * glm::dot(w, a) * w;
}

}  // namespace

EntityMotion reckoned(const EntityState& state, double after_s) {
  const int algorithm = algorithm_of(state);
  EntityMotion motion{state.location_m, glm::dvec3(0.0), glm::dvec3(0.0), state.body, glm::dvec3(0.0)};
  if (algorithm < kFpw) return motion;
  if (turns(algorithm)) {
    motion.turn_rad_s = state.turn_rad_s;
    for (glm::dvec3* axis : {&motion.body.nose, &motion.body.right, &motion.body.below})
      *axis = turned(*axis, state.turn_rad_s, after_s);
  }
  const glm::dvec3 gain_m_s2 = accelerates(algorithm) ? state.acceleration_m_s2 : glm::dvec3(0.0);
  const glm::dvec3 gained_m_s = state.velocity_m_s + gain_m_s2 * after_s;
  if (!is_curved(state)) {
    motion.location_m += (state.velocity_m_s + 0.5 * after_s * gain_m_s2) * after_s;
    motion.velocity_m_s = gained_m_s;
    motion.acceleration_m_s2 = gain_m_s2;
    return motion;
  }
  const glm::dvec3& w = state.turn_rad_s;
  motion.location_m += way_round(state.velocity_m_s, gain_m_s2, w, after_s);
  motion.velocity_m_s = turned(gained_m_s, w, after_s);
  motion.acceleration_m_s2 = glm::cross(w, motion.velocity_m_s) + turned(gain_m_s2, w, after_s);
  return motion;
}

bool is_curved(const EntityState& state) {
  const int algorithm = algorithm_of(state);
  return (algorithm == kRpb || algorithm == kRvb) && state.turn_rad_s != glm::dvec3(0.0);
}

bool stands(const EntityState& state) {
  constexpr double kSlow_m_s = 0.01;  // what simulations leave of a speed in single floats
  return state.frozen || glm::length(state.velocity_m_s) < kSlow_m_s;
}

}  // namespace obliq
