// What modes that look at Doppler refuse, and what they warn of.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "server/control/parameters.h"
#include "server/radar/doppler/doppler_warnings.h"
#include "tests/support/target_scenes.h"

namespace obliq::test::doppler_test {
namespace {

RadarSettings valid(RadarMode mode) {
  RadarSettings s = beam_settings();
  s.mode = mode;
  s.frequency_ghz = 9.4;
  return s;
}

/// The one error, as a sentence.
std::string refused(const RadarSettings& s) {
  const std::vector<FieldError> errors = validate(s);
  EXPECT_EQ(errors.size(), 1u) << all_text(errors);
  return all_text(errors);
}

TEST(DopplerSettings, ThatGoTogetherAreTaken) {
  for (const RadarMode mode : {RadarMode::map, RadarMode::mti, RadarMode::dbs})
    EXPECT_EQ(all_text(validate(valid(mode))), "");
  RadarSettings s = valid(RadarMode::mti);
  s.beam.pattern = BeamPattern::off;
  EXPECT_EQ(all_text(validate(s)), "") << "bin by bin";
  s = valid(RadarMode::sar);
  s.sector_deg = 5;
  s.azimuth_bins = 1024;
  EXPECT_EQ(all_text(validate(s)), "");
}

TEST(DopplerSettings, ThatNoTrainCanBeMadeOfAreRefusedByName) {
  RadarSettings s = valid(RadarMode::pulses);
  EXPECT_EQ(all_text(validate(s)), "");
  s.pulse.prf_hz = 20000;
  EXPECT_EQ(refused(s),
            "pulse.prf_hz: found 20000.0 with radar.r_max_m = 11000.0: the next pulse is sent before the "
            "last gate; "
            "allowed: at most 13626.929 Hz, or radar.r_max_m = 7494.0");
  s.pulse.prf_hz = 13626.929;
  EXPECT_EQ(all_text(validate(s)), "");
  s.pulse.stagger = {1, 0.5, 2};
  EXPECT_NE(refused(s).find("and a pulse.stagger of 0.5"), std::string::npos);
  s = valid(RadarMode::pulses);
  s.speckle = SpeckleKind::none;
  EXPECT_EQ(refused(s).substr(0, 60), "radar.speckle: found \"none\" with radar.mode = \"pulses\"; allo");
  s = valid(RadarMode::pulses);
  s.beam.pattern = BeamPattern::off;
  EXPECT_EQ(refused(s).substr(0, 59), "radar.mode: found \"pulses\" with beam.pattern = \"off\"; allow");
  for (const std::vector<double>& ratios :
       {std::vector<double>{0.4}, {1, 2.1}, std::vector<double>(17, 1.0)}) {
    s = valid(RadarMode::pulses);
    s.pulse.stagger = ratios;
    EXPECT_EQ(refused(s).substr(0, 14), "pulse.stagger:");
  }
}

TEST(DopplerWarnings, SayThatATrainIsLongerThanItsDwell) {
  RadarSettings s = valid(RadarMode::pulses);
  s.scan_mode = ScanMode::sector;
  s.scan_rate_deg_s = 90;
  s.scan_dwell_bins = 16;  // 62.5 ms
  s.pulse.prf_hz = 1000;
  s.doppler.pulses = 62;
  EXPECT_TRUE(doppler_warnings(s, {}).empty());
  s.doppler.pulses = 125;
  const auto warnings = doppler_warnings(s, {});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("doppler.pulses = 125: a train takes 125 ms and a dwell 62.5 ms"),
            std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[0].find("62 pulses fit"), std::string::npos);
}

TEST(DopplerSettings, ThatDoNotAreRefusedByName) {
  RadarSettings s = valid(RadarMode::dbs);
  s.beam.pattern = BeamPattern::off;
  EXPECT_EQ(
      refused(s),
      "radar.mode: found \"dbs\" with beam.pattern = \"off\"; allowed: \"map\", or a beam: what Doppler "
      "tells apart lies in it");
  s = valid(RadarMode::mti);
  s.beam.pattern = BeamPattern::off;
  s.scan_mode = ScanMode::sector;
  EXPECT_TRUE(refused(s).starts_with("radar.mode: found \"mti\" with beam.pattern = \"off\";"));

  s = valid(RadarMode::sar);
  s.azimuth_bins = 4096;
  EXPECT_EQ(refused(s).substr(0, 60), "radar.sector_deg: found 90.0 with radar.mode = \"sar\"; allowe");
  s.sector_deg = 5;
  s.azimuth_bins = 64;
  s.doppler.resolution_m = 0.5;
  // 11 km x 5 degrees / 64 bins is 15 m, and eight parts of a bin two a cell: 3.75 m.
  EXPECT_EQ(refused(s),
            "doppler.resolution_m: found 0.5 with bins.azimuth = 64 and radar.r_max_m = 11000.0; allowed: at "
            "least 3.75 m, or bins.azimuth = 480");
  s.doppler.resolution_m = 3.75;
  EXPECT_EQ(all_text(validate(s)), "") << "what it says would do does";
  s.doppler.resolution_m = 0.5;
  s.azimuth_bins = 480;
  EXPECT_EQ(all_text(validate(s)), "");
  s.sector_deg = 0.001;
  EXPECT_EQ(
      refused(s),
      "doppler.resolution_m: found 0.5 in radar.sector_deg = 0.001 with bins.azimuth = 480: more rows than "
      "16384.0; allowed: fewer bins.azimuth, or a wider sector");
  s.sector_deg = 5;
  s.scan_mode = ScanMode::sector;
  EXPECT_EQ(refused(s).substr(0, 60), "scan.mode: found a scan with radar.mode = \"sar\"; allowed: \"f");
}

TEST(DopplerSettings, OutsideTheirLimitsAreRefused) {
  const struct {
    const char* field;
    std::function<void(RadarSettings&)> spoil;
  } kWrong[] = {{"pulse.prf_hz", [](RadarSettings& s) { s.pulse.prf_hz = 0; }},
                {"pulse.prf_hz", [](RadarSettings& s) { s.pulse.prf_hz = NAN; }},
                {"doppler.pulses", [](RadarSettings& s) { s.doppler.pulses = 1; }},
                {"doppler.pulses", [](RadarSettings& s) { s.doppler.pulses = 1025; }},
                {"doppler.canceller", [](RadarSettings& s) { s.doppler.canceller = 4; }},
                {"doppler.resolution_m", [](RadarSettings& s) { s.doppler.resolution_m = 0.49; }},
                {"atmosphere.wind_m_s", [](RadarSettings& s) { s.atmosphere.wind_m_s = -1; }}};
  for (const auto& wrong : kWrong) {
    RadarSettings s = valid(RadarMode::dbs);
    wrong.spoil(s);
    EXPECT_EQ(refused(s).substr(0, std::string(wrong.field).size()), wrong.field);
  }
}

TEST(DopplerPlans, ThatNeedFinerRowsThanThereAreSayWhatWouldDo) {
  TargetScene scene(level_world());
  scene.pose().settings.velocity_east_m_s = 300;
  RadarSettings s = valid(RadarMode::dbs);
  s.doppler.pulses = 1024;  // 1 s: B = 985 cells
  // When it is set.
  const auto fault = [&](const RadarSettings& settings) {
    return all_text(beam_faults(scene.shared(), settings, scene.pose()));
  };
  EXPECT_EQ(fault(s),
            "doppler.pulses: found 1024 pulses at 1000 Hz and 300 m/s with bins.azimuth = 256; allowed: "
            "bins.azimuth = 3794 or at most 66 pulses or pulse.prf_hz = 15455");
  // In a flight that has become so fast frames go on, with the same sentence as a warning.
  const PlanResult flown = plan_frame(scene.shared(), snapshot(s), scene.pose());
  ASSERT_TRUE(flown.plan) << all_text(flown.errors);
  EXPECT_EQ(flown.plan->sum()->doppler_warning, fault(s));
  RadarSettings mended = s;
  mended.doppler.pulses = 66;
  EXPECT_EQ(fault(mended), "");
  mended = s;
  mended.pulse.prf_hz = 15455;
  EXPECT_EQ(fault(mended), "");
  s.mode = RadarMode::mti;
  s.pulse.prf_hz = 2;
  EXPECT_EQ(fault(s).substr(0, 60), "pulse.prf_hz: found a canceller at 2 Hz and 300 m/s with bin");
}

TEST(DopplerPlans, OfAnImageWithoutAFlightSayWhatIsMissing) {
  TargetScene scene(level_world());
  RadarSettings s = valid(RadarMode::sar);
  s.sector_deg = 5;
  s.azimuth_bins = 1024;
  const auto fault = [&] { return all_text(plan_frame(scene.shared(), snapshot(s), scene.pose()).errors); };
  EXPECT_EQ(
      fault(),
      "radar.mode: found \"sar\" of an antenna that flies across its line of sight at 0.00 m/s; allowed: "
      "poses "
      "with a velocity across the sector's middle (antenna.velocity_north_m_s, _east_), or another mode");
  scene.pose().settings.velocity_up_m_s = -100;
  EXPECT_NE(fault(), "") << "straight down";
  scene.pose().settings.velocity_east_m_s = 100;
  EXPECT_EQ(fault(), "");
}

TEST(DopplerWarnings, NameWhatAMapCannotShow) {
  RadarSettings s = valid(RadarMode::dbs);
  s.r_min_m = 1000;
  const auto first = [&](double ahead_m_s, double right_m_s) {
    const auto warnings = doppler_warnings(s, {ahead_m_s, right_m_s, 0});
    return warnings.empty() ? std::string() : warnings.front();
  };
  EXPECT_EQ(first(0, 0).substr(0, 58), "radar.mode = \"dbs\" of an antenna without a velocity across");
  EXPECT_EQ(first(0, 100), "");
  s.pulse.prf_hz = 300;
  EXPECT_EQ(
      first(0, 100),
      "pulse.prf_hz = 300: the ground in the beam is 328 Hz wide, so that azimuths are ambiguous; above "
      "329 Hz they are not");
  s.pulse.prf_hz = 1000;
  s.doppler.pulses = 200;
  EXPECT_EQ(
      first(0, 100),
      "doppler.pulses = 200: the antenna flies 20.0 m in a train, more than half a range bin of 19.5 m, "
      "and echoes are taken to stay in theirs");
}

}  // namespace
}  // namespace obliq::test::doppler_test
