#include <gtest/gtest.h>

#include "client/socket.h"

namespace obliq::client {
namespace {

TEST(Endpoint, TakesHostsAndPorts) {
  EXPECT_EQ(parse_endpoint("radar.example:99")->text(), "radar.example:99");
  EXPECT_EQ(parse_endpoint("10.0.0.1")->text(), "10.0.0.1:7420");
  EXPECT_EQ(parse_endpoint("[::1]:80")->host, "::1");
  EXPECT_EQ(parse_endpoint("[::1]:80")->text(), "[::1]:80");
  EXPECT_EQ(parse_endpoint("[::1]")->port, 7420);
  EXPECT_EQ(parse_endpoint(":99")->text(), "127.0.0.1:99");
  EXPECT_EQ(parse_endpoint("99")->text(), "127.0.0.1:99");
}

TEST(Endpoint, RefusesWhatIsNone) {
  for (const char* text : {"", ":", "0", "65536", ":0", ":65536", "1:2:3", "host:", "host:0", "host:65536",
                           "host:-1", "host:12x", "host: 12", "[::1", "[::1]80", "::1", "[]:5"}) {
    EXPECT_FALSE(parse_endpoint(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace obliq::client
