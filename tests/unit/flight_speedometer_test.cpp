#include <gtest/gtest.h>

#include "server/flight/window.h"

namespace obliq::test {
namespace {

using Time = Speedometer::Time;

std::vector<RadarPlace> at(double longitude_deg, double latitude_deg) {
  return {{{longitude_deg, latitude_deg}, 1000}};
}
Time second(double s) { return Time(std::chrono::milliseconds(static_cast<int>(1000 * s))); }

TEST(Speedometer, GoesOnAsTheRadarsDo) {
  Speedometer speed;
  speed.note(at(10, 50), second(100));
  EXPECT_EQ(speed.ahead(at(10, 50), 60, second(100))[0].position.longitude_deg, 10) << "nothing is known yet";
  speed.note(at(10.001, 50.002), second(101));
  const LonLat later = speed.ahead(at(10.001, 50.002), 10, second(101))[0].position;
  EXPECT_NEAR(later.longitude_deg, 10.011, 1e-9);
  EXPECT_NEAR(later.latitude_deg, 50.022, 1e-9);
}

TEST(Speedometer, PosesInQuickSuccessionDoNotShakeIt) {
  Speedometer speed;
  for (int i = 0; i <= 120; ++i) speed.note(at(10 + 1e-5 * i + (i % 2) * 1e-6, 50), second(100 + i / 60.0));
  // 60 poses a second of 1e-5 degrees each; the jitter of 1e-6 counts for half a second at least.
  EXPECT_NEAR(speed.ahead(at(0, 50), 10, second(102))[0].position.longitude_deg, 6e-3, 5e-5);
}

TEST(Speedometer, CrossesTheAntimeridian) {
  Speedometer speed;
  speed.note(at(179.9995, 0), second(100));
  speed.note(at(-179.9995, 0), second(101));
  EXPECT_NEAR(distance_m(speed.ahead(at(-179.9995, 0), 10, second(101))[0].position, {-179.9895, 0}), 0, 0.1);
}

TEST(Speedometer, RadarsOfWhichNothingIsHeardForTwoSecondsStandStill) {
  Speedometer speed;
  speed.note(at(10, 50), second(100));
  speed.note(at(11, 50), second(101));  // a jump, or the last of a flight
  EXPECT_NEAR(speed.ahead(at(11, 50), 10, second(103))[0].position.longitude_deg, 21, 1e-9);
  EXPECT_EQ(speed.ahead(at(11, 50), 10, second(103.001))[0].position.longitude_deg, 11);
  speed.note(at(11, 50), second(103.1));
  EXPECT_NEAR(speed.ahead(at(11, 50), 10, second(103.2))[0].position.longitude_deg, 11, 1e-9);
}

}  // namespace
}  // namespace obliq::test
