// Where a bin lies: the worked bin that PROTOCOL.md prints, against GeographicLib and the pictures'
// projection.
#include <gtest/gtest.h>

#include <GeographicLib/AzimuthalEquidistant.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "proto/obliq.pb.h"
#include "server/output/map_projection.h"
#include "terrain/frames.h"

namespace obliq {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
/// The document prints millimetres and a thousandth of a micro-degree, 0.1 mm.
constexpr double kPrinted_m = 0.001;
constexpr double kPrinted_deg = 0.6e-9;

using Numbers = std::map<std::string, double>;

/// The lines "name value" between "```kind" and "```".
Numbers block_of_the_protocol_document(const std::string& kind) {
  std::ifstream file(OBLIQ_SOURCE_DIR "/proto/PROTOCOL.md");
  Numbers numbers;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```" + kind;
    } else if (inside) {
      std::istringstream words(line);
      std::string name;
      words >> name >> numbers[name];
    }
  }
  return numbers;
}

struct WorkedBin {
  Numbers given = block_of_the_protocol_document("bin");
  Numbers place = block_of_the_protocol_document("place");

  double bearing_rad() const {
    return (given.at("azimuth_start_deg") + (given.at("azimuth_bin") + 0.5) * given.at("azimuth_width_deg")) *
           kDegree;
  }
  double slant_range_m() const {
    return given.at("range_start_m") + (given.at("range_bin") + 0.5) * given.at("range_spacing_m");
  }
  WorldFrame frame() const {
    return {given.at("origin_latitude_deg") * kDegree, given.at("origin_longitude_deg") * kDegree,
            given.at("radius_factor")};
  }
};

TEST(ProtocolDocument, TheWorkedBinsPlaceIsAtItsSlantRangeAndBearing) {
  const WorkedBin bin;
  ASSERT_EQ(bin.given.size(), 14u);
  ASSERT_EQ(bin.place.size(), 6u);
  const WorldPoint world = bin.frame().world_from_geodetic({bin.place.at("latitude_deg") * kDegree,
                                                            bin.place.at("longitude_deg") * kDegree,
                                                            bin.given.at("map_reference_height_m")});
  EXPECT_NEAR(world.m.x, bin.place.at("x_m"), kPrinted_m);
  EXPECT_NEAR(world.m.y, bin.place.at("y_m"), kPrinted_m);
  EXPECT_NEAR(world.m.z, bin.place.at("z_m"), kPrinted_m);
  const double dx = world.m.x - bin.given.at("antenna_x_m");
  const double dy = world.m.y - bin.given.at("antenna_y_m");
  const double dz = world.m.z - bin.given.at("antenna_z_m");
  EXPECT_NEAR(std::sqrt(dx * dx + dy * dy + dz * dz), bin.slant_range_m(), kPrinted_m);
  EXPECT_NEAR(std::hypot(dx, dz), bin.place.at("ground_range_m"), kPrinted_m);
  EXPECT_NEAR((std::atan2(dx, dz) - bin.given.at("north_rad") - bin.bearing_rad()) * bin.slant_range_m(), 0,
              kPrinted_m);
}

TEST(ProtocolDocument, PicturesPlaceTheWorkedBinThere) {
  const WorkedBin bin;
  const WorldPoint antenna{
      {bin.given.at("antenna_x_m"), bin.given.at("antenna_y_m"), bin.given.at("antenna_z_m")}};
  const Geodetic at = bin.frame().geodetic_from_world(antenna);
  wire::FrameDescriptor descriptor;
  descriptor.mutable_pose()->set_latitude_deg(at.latitude_rad / kDegree);
  descriptor.mutable_pose()->set_longitude_deg(at.longitude_rad / kDegree);
  descriptor.mutable_settings()->set_azimuth_bins(240);
  descriptor.mutable_settings()->set_range_bins(1000);
  // The block's names are the descriptor's, so reflection sets them.
  for (const auto& [name, value] : bin.given) {
    const auto* field = descriptor.GetDescriptor()->FindFieldByName(name);
    if (field) descriptor.GetReflection()->SetDouble(&descriptor, field, value);
  }
  const MapProjection projection(descriptor);
  const auto place = projection.place(bin.bearing_rad(), bin.slant_range_m());
  double latitude_deg, longitude_deg;
  GeographicLib::AzimuthalEquidistant().Reverse(descriptor.pose().latitude_deg(),
                                                descriptor.pose().longitude_deg(), place.east_m,
                                                place.north_m, latitude_deg, longitude_deg);
  EXPECT_NEAR(latitude_deg, bin.place.at("latitude_deg"), kPrinted_deg);
  EXPECT_NEAR(longitude_deg, bin.place.at("longitude_deg"), kPrinted_deg);
}

}  // namespace
}  // namespace obliq
