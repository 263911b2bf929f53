// Kernels of Doppler against sums over pulses in double; the same bits whatever the instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "server/radar/doppler/canceller.h"
#include "server/radar/doppler/doppler_response.h"
#include "server/radar/simd/kernels.h"

namespace obliq::doppler_sums_test {
namespace {

constexpr int kBins = 2 * CellSpan::kBins;
constexpr int kRows = 21;
constexpr int kStep = 2;  // rows from an output to the next
constexpr int kOutputs = WeighedRows::kOutputs;
constexpr int kPad = (kOutputs - 1) * kStep;
constexpr int kTaps = kRows + kPad;
using Rows = std::vector<std::vector<float>>;
using Pointers = std::vector<const float*>;

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }

 private:
  std::mt19937 random_;
};

Pointers pointers(const Rows& rows) {
  Pointers all;
  for (const auto& row : rows) all.push_back(row.data());
  return all;
}

/// Rows with voltages, and where sums over them go.
struct Sums {
  Dice dice{29};
  Rows power{kRows}, re{kRows}, im{kRows};
  Pointers powers, res, ims;
  std::vector<std::int32_t> taps_at;
  std::vector<float> out_power, out_iq;

  Sums() {
    for (auto* const rows : {&power, &re, &im})
      for (auto& row : *rows)
        for (int x = 0; x < kBins; ++x) row.push_back(static_cast<float>(dice.uniform(-1, 1)));
    for (auto& row : power)
      for (float& x : row) x = std::abs(x);
    powers = pointers(power);
    res = pointers(re);
    ims = pointers(im);
    for (int k = 0; k < kRows; ++k) taps_at.push_back(kPad + k);
  }

  WeighedRows rows() {
    out_power.assign(kOutputs * kBins, -1);
    out_iq.assign(2 * out_power.size(), -1);
    WeighedRows of{powers.data(), res.data(), ims.data(), kRows, kStep, taps_at.data(), 0, 0, kBins, {}, {}};
    for (int o = 0; o < kOutputs; ++o) {
      of.out_power[o] = out_power.data() + o * kBins;
      of.out_iq[o] = out_iq.data() + 2 * o * kBins;
    }
    return of;
  }

  /// Of a weight by row, tap, output and bin. off: of a weight, over the greatest of them or, of an absolute
  /// error, over 1.
  template <typename Weight>
  void expect(const Weight& weight, double off, bool absolute, const char* name) const {
    for (int o = 0; o < kOutputs; ++o)
      for (int x = 0; x < kBins; ++x) {
        double sum = 0, size = 0;
        std::complex<double> iq = 0;
        for (int k = 0; k < kRows; ++k) {
          const std::complex<double> w = weight(k, kPad + k - o * kStep, o, x);
          const auto row = static_cast<std::size_t>(k);
          const auto bin = static_cast<std::size_t>(x);
          sum += static_cast<double>(power[row][bin]) * std::norm(w);
          iq += w * std::complex<double>(re[row][bin], im[row][bin]);
          size = std::max(size, std::abs(w));
        }
        const auto at = static_cast<std::size_t>(o * kBins + x);
        const double tolerance = off * kRows * (absolute ? 1 : size);
        ASSERT_NEAR(out_power[at], sum, 2 * size * tolerance) << name;
        ASSERT_NEAR(out_iq[2 * at], iq.real(), tolerance) << name << ' ' << o << ' ' << x;
        ASSERT_NEAR(out_iq[2 * at + 1], iq.imag(), tolerance) << name << ' ' << o << ' ' << x;
      }
  }
};

/// With any instruction set; the same bits.
template <typename Run, typename Expect>
void with_all_kernels(Sums& sums, const Run& run, const Expect& expect) {
  std::vector<float> power, iq;
  for (const Kernels& kernels : all_kernels()) {
    run(kernels);
    expect(kernels.name);
    if (power.empty()) {
      power = sums.out_power;
      iq = sums.out_iq;
    }
    EXPECT_EQ(sums.out_power, power) << kernels.name;
    EXPECT_EQ(sums.out_iq, iq) << kernels.name;
  }
}

// Gains that hardly differ, and rows that hardly turn: what is left is 1e-4 of them and less, to 1e-5 of
// that.
TEST(CancelledSum, IsTheDifferenceOfItsPulses) {
  for (int delays = 1; delays <= 3; ++delays)
    for (const bool locked : {false, true})
      for (const double most_turns : {0.003, 0.5}) {
        Sums sums;
        const double root = std::sqrt(canceller_noise_gain(delays));
        std::vector<std::vector<double>> gains;
        std::vector<float> taps;
        for (int j = 0; j < kTaps; ++j) {
          std::vector<double>& of_tap = gains.emplace_back();
          for (int i = 0; i <= delays; ++i) of_tap.push_back(std::exp(-std::pow((j - 20 + 0.1 * i) / 10, 2)));
          const CancellerTerms terms = canceller_terms(of_tap);
          for (const double term : {terms.even[0], terms.even[1], terms.odd[0], terms.odd[1]})
            taps.push_back(static_cast<float>(term / root));
        }
        std::vector<std::vector<double>> turns;  // of rows, then of outputs
        Rows sin, cos;
        for (int k = 0; k < kRows + kOutputs; ++k) {
          auto& of = turns.emplace_back();
          sin.emplace_back();
          cos.emplace_back();
          for (int x = 0; x < kBins; ++x) {
            of.push_back(sums.dice.uniform(-most_turns, most_turns));
            sin.back().push_back(static_cast<float>(std::sin(std::numbers::pi * of.back())));
            cos.back().push_back(static_cast<float>(std::cos(std::numbers::pi * of.back())));
          }
        }
        const Pointers sines = pointers(sin), cosines = pointers(cos);
        with_all_kernels(
            sums,
            [&](const Kernels& kernels) {
              CancelledSum sum{sums.rows(), taps.data(), sines.data(), cosines.data(), {},
                               {},          delays,      nullptr,      nullptr,        {}};
              for (int o = 0; locked && o < kOutputs; ++o) {
                sum.output_sin[o] = sines[static_cast<std::size_t>(kRows + o)];
                sum.output_cos[o] = cosines[static_cast<std::size_t>(kRows + o)];
              }
              kernels.cancelled_sum(sum);
            },
            [&](const char* name) {
              sums.expect(
                  [&](int k, int tap, int o, int x) {
                    const auto bin = static_cast<std::size_t>(x);
                    const double at = turns[static_cast<std::size_t>(k)][bin] -
                                      (locked ? turns[static_cast<std::size_t>(kRows + o)][bin] : 0);
                    std::complex<double> sum = 0;
                    for (int i = 0; i <= delays; ++i)
                      sum += (i % 2 == 0 ? 1 : -1) * binomial(delays, i) *
                             gains[static_cast<std::size_t>(tap)][static_cast<std::size_t>(i)] *
                             std::polar(1.0, 2 * std::numbers::pi * at * (delays / 2.0 - i));
                    return sum / root;
                  },
                  1e-5, false, name);
            });
      }
}

// D of Hamming's weights; tiles of which all bins lie near each other, and others.
TEST(SharpenedSum, IsTheSumOverItsPulses) {
  for (const int pulses : {15, 16}) {
    RadarSettings s;
    s.mode = RadarMode::dbs;
    s.doppler.pulses = pulses;
    const DopplerResponse response(s);
    Sums sums;
    std::vector<float> taps;
    for (int j = 0; j < kTaps; ++j) taps.push_back(static_cast<float>(sums.dice.uniform(0.1, 1)));
    std::vector<float> cells_a_hz, away_hz;
    for (int x = 0; x < kBins; ++x) cells_a_hz.push_back(0.01F * (1 + 0.001F * static_cast<float>(x)));
    for (int k = 0; k < kRows; ++k)
      for (int o = 0; o < kOutputs; ++o)
        away_hz.push_back(static_cast<float>(sums.dice.uniform(-4000, 4000)) / (k % 3 == 0 ? 1 : 20));
    Rows beside(kRows);
    std::vector<std::vector<CellSpan>> spans(kRows);
    const auto span_of = [](const float* from) {
      const auto [low, high] = std::minmax_element(from, from + CellSpan::kBins);
      return CellSpan{0.5F * (*low + *high), 0.5F * (*high - *low)};
    };
    std::vector<CellSpan> level;
    for (int tile = 0; tile < 2; ++tile) level.push_back(span_of(cells_a_hz.data() + tile * CellSpan::kBins));
    for (std::size_t k = 0; k < beside.size(); ++k) {
      const double wide = k % 2 == 0 ? 0.1 : 2;
      for (int x = 0; x < kBins; ++x) beside[k].push_back(static_cast<float>(sums.dice.uniform(1, 1 + wide)));
      for (int tile = 0; tile < 2; ++tile)
        spans[k].push_back(span_of(beside[k].data() + tile * CellSpan::kBins));
    }
    std::vector<const CellSpan*> of_rows;
    for (const auto& row : spans) of_rows.push_back(row.data());
    const Pointers besides = pointers(beside);
    with_all_kernels(
        sums,
        [&](const Kernels& kernels) {
          kernels.sharpened_sum({sums.rows(), taps.data(), besides.data(), of_rows.data(), away_hz.data(),
                                 cells_a_hz.data(), level.data(), response.table()});
        },
        [&](const char* name) {
          sums.expect(
              [&](int k, int tap, int o, int x) {
                const auto row = static_cast<std::size_t>(k);
                const auto bin = static_cast<std::size_t>(x);
                const double u = static_cast<double>(beside[row][bin]) +
                                 static_cast<double>(away_hz[row * kOutputs + static_cast<std::size_t>(o)]) *
                                     static_cast<double>(cells_a_hz[bin]);
                double sum = 0, weights = 0;
                for (int n = 0; n < pulses; ++n) {
                  const double t = (n - (pulses - 1) / 2.0) / pulses;
                  const double w = 0.54 + 0.46 * std::cos(2 * std::numbers::pi * t);
                  sum += w * std::cos(2 * std::numbers::pi * u * t);
                  weights += w;
                }
                return std::complex<double>(static_cast<double>(taps[static_cast<std::size_t>(tap)]) * sum /
                                            weights);
              },
              2e-4, true, name);
        });
  }
}

// A beam over level ground stands at 0; dark bins do not count for where a tile lies.
TEST(DopplerCells, AreThoseBesideLevelGround) {
  Dice dice(31);
  std::vector<float> sine, level_sine, power;
  std::vector<double> turns_a_hz;
  for (int x = 0; x < kBins; ++x) {
    level_sine.push_back(-0.3F + 0.002F * static_cast<float>(x));
    sine.push_back(level_sine.back() + static_cast<float>(dice.uniform(0, 0.01)));
    power.push_back(x % 5 == 0 ? 0.0F : 1.0F);
    if (x % 5 == 0) sine.back() = 0;
    turns_a_hz.push_back(0.064);
  }
  std::fill_n(power.begin() + CellSpan::kBins, CellSpan::kBins, 0.0F);
  for (const Kernels& kernels : all_kernels()) {
    std::vector<float> cells(kBins);
    CellSpan spans[2];
    kernels.doppler_cells({{kBins, sine.data(), turns_a_hz.data(), 8000, 200},
                           170,
                           level_sine.data(),
                           power.data(),
                           cells.data(),
                           spans});
    double low = 1e9, high = -1e9;
    for (std::size_t x = 0; x < kBins; ++x) {
      const auto hz = [](double sin, double up_hz) { return 8000 * std::sqrt(1 - sin * sin) + up_hz * sin; };
      const double wanted =
          0.064 * (hz(static_cast<double>(sine[x]), 200) - hz(static_cast<double>(level_sine[x]), 170));
      EXPECT_NEAR(cells[x], wanted, 1e-6 * std::abs(wanted));
      if (x >= CellSpan::kBins || power[x] == 0) continue;
      low = std::min(low, wanted);
      high = std::max(high, wanted);
    }
    EXPECT_NEAR(spans[0].middle - spans[0].reach, low, 1e-5);
    EXPECT_NEAR(spans[0].middle + spans[0].reach, high, 1e-5);
    EXPECT_LT(spans[1].reach, 0);
  }
}

}  // namespace
}  // namespace obliq::doppler_sums_test
