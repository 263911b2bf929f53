// Prints attenuations for tests/accuracy/radar/receiver/weather_itur.py: kind, frequency in GHz, rain in
// mm/h, dB/km.
#include <cstdio>

#include "server/radar/receiver/weather.h"

int main() {
  using obliq::Polarisation;
  for (const double f : {1.0, 3.0, 5.6, 9.4, 10.0, 16.0, 22.2, 24.0, 35.0, 60.0, 77.0, 94.0, 183.0, 300.0}) {
    std::printf("gas %.17g 0 %.17g\n", f, obliq::gas_attenuation_db_km(f));
    for (const double rain : {0.25, 4.0, 16.0, 100.0}) {
      std::printf("H %.17g %.17g %.17g\n", f, rain,
                  obliq::rain_attenuation_db_km(rain, f, Polarisation::horizontal));
      std::printf("V %.17g %.17g %.17g\n", f, rain,
                  obliq::rain_attenuation_db_km(rain, f, Polarisation::vertical));
    }
  }
}
