// Flies a radar of a running obliqd round a racetrack and reports what its display notices:
//   flight_bench HOST:PORT PID LATITUDE LONGITUDE STRAIGHT_KM RADIUS_KM DISTANCE_KM SPEED_M_S FRAMES_HZ
#include <cstdio>
#include <cstdlib>

#include "client/socket.h"
#include "tests/flight/flight_run.h"

int main(int argc, char** argv) {
  const auto endpoint = argc == 10 ? obliq::client::parse_endpoint(argv[1]) : std::nullopt;
  if (!endpoint) {
    std::fprintf(stderr,
                 "flight_bench HOST:PORT PID LATITUDE LONGITUDE STRAIGHT_KM RADIUS_KM DISTANCE_KM SPEED_M_S "
                 "FRAMES_HZ\n");
    return 2;
  }
  const auto number = [&](int i) { return std::atof(argv[i]); };
  obliq::test::FlightOrder order;
  order.server = *endpoint;
  order.server_pid = std::atoi(argv[2]);
  order.course = {number(3), number(4), 1000 * number(5), 1000 * number(6)};
  order.distance_m = 1000 * number(7);
  order.speed_m_s = number(8);
  order.frame_rate_hz = number(9);
  order.print = true;
  const obliq::test::FlightReport report = obliq::test::fly(order);
  std::printf("%s\n", report.text().c_str());
  return report.failure.empty() ? 0 : 1;
}
