#pragma once
#include <vector>

namespace obliq {

/// A weighting over an aperture or a band, and its transform: the voltage pattern of the aperture, or the
/// point response of the band. Cosine series W(x) = 1 + 2 sum F_m cos(2 pi m x), |x| <= 1/2, of mean 1; or
/// the half cosine cos(pi x). u counts beamwidths lambda / D, or resolutions c / 2B.
class Taper {
 public:
  static Taper uniform() { return Taper({}); }
  static Taper half_cosine();
  /// 0.54 + 0.46 cos and 0.5 + 0.5 cos (Harris 1978).
  static Taper hamming() { return Taper({0.46 / (2 * 0.54)}); }
  static Taper hann() { return Taper({0.5}); }
  /// The minimum of four terms, -92 dB (Harris 1978).
  static Taper blackman_harris();
  /// Taylor 1955, as scipy.signal.windows.taylor: `nbar` nearly constant sidelobes `sidelobe_db` below the
  /// peak.
  static Taper taylor(int nbar, double sidelobe_db);

  /// Real, even, 1 at u = 0.
  double transform(double u) const;
  /// Full width of the squared transform at half its peak.
  double half_power_width() const { return width_; }
  /// mean W^2 / (mean W)^2: what a matched filter with this weighting loses, and the integral of the squared
  /// transform.
  double noise_width() const;

  /// The transform of n weights, W at the middles of n parts: sinc(u) becomes sin(pi u) / (n sin(pi u / n)).
  double sampled(double u, int n) const;
  /// Those weights, of sum 1.
  std::vector<double> sampled_weights(int n) const;
  /// n sum W^2 / (sum W)^2 of them.
  double sampled_noise_width(int n) const;

 private:
  explicit Taper(std::vector<double> series, bool half_cosine = false);
  double weight(double x) const;

  std::vector<double> series_;
  bool half_cosine_;
  double width_ = 0;
};

/// sin(pi u) / (pi u).
double sinc(double u);

}  // namespace obliq
