// What frames of modes lose with fewer sharp rows a beamwidth than Doppler asks for (rows_a_beamwidth), and
// what the rows cost: the figures of ACCURACY.md, "Rows of a beam".
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

#include "server/radar/doppler/ground_doppler.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/figures.h"
#include "tests/support/target_scenes.h"

namespace obliq::test::doppler_rows_test {
namespace {

constexpr double kBeam_deg = 3;
constexpr int kBins = 20;  // a beamwidth wide each: rows are whole numbers a beamwidth
constexpr double kSpeed_m_s = 150;

struct Mode {
  const char* name;
  RadarMode mode;
  double cells;  // of the ground in the beam, abeam
};
constexpr Mode kModes[] = {{"dbs", RadarMode::dbs, 1}, {"mti", RadarMode::mti, 1}};

/// A sector from 30 degrees off the course to abeam, over hills.
RadarSettings settings_of(const Mode& mode) {
  RadarSettings s =
      radar_settings(FrustumKind::sweep, {4000, 12'000, kBins * kBeam_deg}, {kBins, 512}, {64 * kBins, 1});
  s.mode = mode.mode;
  s.frequency_ghz = 9.4;
  s.power_w = 1000;
  s.gain_db = 30;
  s.speckle = SpeckleKind::ground;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = kBeam_deg;
  s.beam.extent_deg = 8;
  s.doppler.pulses = 8;
  s.doppler.window = DopplerWindow::none;
  s.doppler.clutter_lock = true;
  // B = 2 v theta T / lambda; T that of 8 pulses, or of the canceller's two delays.
  const int pulses = mode.mode == RadarMode::dbs ? s.doppler.pulses : s.doppler.canceller;
  const double width_hz = 2 * kSpeed_m_s * kBeam_deg * kDegree_rad / (299792458.0 / 9.4e9);
  s.pulse.prf_hz = width_hz * pulses / mode.cells * (1 + 1e-6);
  return s;
}

class RowsOfABeam : public testing::Test {
 protected:
  RowsOfABeam() {
    PoseSettings& at = scene_.pose().settings;
    at.velocity_north_m_s = kSpeed_m_s;
    scene_.pose().bearing_world_rad = 60 * kDegree_rad;
    at.bearing_deg = 60 - scene_.pose().north_rad / kDegree_rad;
  }

  /// Power of each bin; of `finer` times as many azimuth bins those in the middles.
  std::vector<double> powers(RadarSettings s, int finer) const {
    s.azimuth_bins *= finer;
    const Frame frame = scene_.bare(s);
    std::vector<double> powers;
    for (int a = 0; a < kBins; ++a) {
      const auto row = static_cast<std::size_t>(a * finer + finer / 2) * 512;
      for (std::size_t r = 0; r < 512; ++r) powers.push_back(frame.bins.power_w[row + r]);
    }
    return powers;
  }

  /// Processor time of a frame with one plane a row, as a display has them: the least of seven.
  double least_cpu_s(RadarSettings s) const {
    s.pixel_columns = kBins;
    double least = 1e9;
    for (int turn = 0; turn < 7; ++turn) {
      const std::clock_t start = std::clock();
      (void)scene_.bare(s);
      least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return least;
  }

  TargetScene scene_{made_world(15'000, 100, [](double x_m, double z_m) { return hills_m(x_m, z_m) / 10; })};
};

TEST_F(RowsOfABeam, AreThreeMoreThanItsCellsForAReason) {
  for (const Mode& mode : kModes) {
    RadarSettings s = settings_of(mode);
    EXPECT_NEAR(cells_in_beam(s, kBeam_deg * kDegree_rad, kSpeed_m_s), mode.cells, 1e-4);
    RadarSettings dense = s;
    dense.doppler.rows_beside_cells = 35;  // eight rows a bin of five times as many: 40 a beamwidth
    const std::vector<double> truth = powers(dense, 5);
    double before = 1;
    for (const int beside : {1, 2, 3}) {
      s.doppler.rows_beside_cells = beside;
      const std::vector<double> found = powers(s, 1);
      const double cpu_s = least_cpu_s(s);
      double sum = 0, error = 0, squares = 0, worst = 0;
      for (const double power : truth) sum += power;
      const double mean = sum / static_cast<double>(truth.size());
      for (std::size_t k = 0; k < truth.size(); ++k) {
        error += found[k] - truth[k];
        if (truth[k] < 0.01 * mean) continue;  // 20 dB below the mean: hardly lit
        const double off = found[k] / truth[k] - 1;
        squares += off * off / static_cast<double>(truth.size());
        worst = std::max(worst, std::abs(off));
      }
      const std::string name = std::string(mode.name) + "_" + std::to_string(beside);
      std::printf("    %s, B + %d: total %+.5f, rms %.5f, worst %.4f, %.1f ms\n", mode.name, beside,
                  error / sum, std::sqrt(squares), worst, 1000 * cpu_s);
      record_figure(name + "_total", error / sum);
      record_figure(name + "_rms", std::sqrt(squares));
      record_figure(name + "_worst", worst);
      record_figure(name + "_ms", 1000 * cpu_s);
      EXPECT_LT(std::sqrt(squares), before);
      before = std::sqrt(squares);
    }
    EXPECT_LT(before, 0.01);
  }
}

}  // namespace
}  // namespace obliq::test::doppler_rows_test
