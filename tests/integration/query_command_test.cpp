// `obliq query` against a real daemon over ground whose shape is known.
#include <gtest/gtest.h>

#include <sstream>

#include "terrain/base/text.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

class QueryCommand : public testing::Test {
 protected:
  QueryCommand() {
    SmallScene scene;  // a ridge across the north, 5 km from the antenna and nearly as high
    scene.terrain = "synthetic = \"ridge\"\nshape = { distance_m = 5000.0, height_m = 1400.0 }\n";
    scene.antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\n";
    scene.radars = kTwoRadars;
    daemon = std::make_unique<Daemon>(
        std::vector<std::string>{"--config", folder.write("scene.toml", text_of(scene)), "--port", "0"},
        folder.path());
  }
  Outcome query(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "query");
    arguments.insert(arguments.end(), {"--server", daemon->address()});
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  void expect_refused(const std::vector<std::string>& arguments, const std::string& part) {
    const Outcome outcome = query(arguments);
    EXPECT_EQ(outcome.code, 1) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin: " << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }

  TestFolder folder;
  std::unique_ptr<Daemon> daemon;
};

TEST_F(QueryCommand, SaysWhatIsThereAndWhetherTheRadarSeesIt) {
  // 7 km north, behind the crest; 2 km south, nothing in the way; 100 km east.
  const Outcome outcome =
      query({"--radar", "nose", "--at", "33.0631,-99.5", "--at", "32.982,-99.5", "--at", "33.0,-98.4"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string behind, seen, outside;
  std::getline(lines, behind);
  std::getline(lines, seen);
  std::getline(lines, outside);
  EXPECT_NE(behind.find("is hidden by ground"), std::string::npos) << behind;
  EXPECT_NE(seen.find("is seen"), std::string::npos) << seen;
  EXPECT_NE(seen.find("ground 0.00 m"), std::string::npos) << seen;
  EXPECT_NE(outside.find("beyond the loaded terrain"), std::string::npos) << outside;
}

TEST_F(QueryCommand, TakesFilesOfPointsInManyQueriesAndPrintsTables) {
  std::string points = "latitude,longitude\n# the plain south of the antenna\n";
  for (int k = 0; k < 10500; ++k) points += std::to_string(32.99 - 1e-6 * k) + ",-99.5\n";
  const Outcome outcome = query({"--no-sight", "--csv", "--points", folder.write("points.csv", points)});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = csv_fields(line);
  EXPECT_EQ(header[0], "latitude_deg");
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const std::vector<std::string> fields = csv_fields(line);
    ASSERT_EQ(fields.size(), header.size()) << line;
    ASSERT_NEAR(std::stod(fields[0]), 32.99 - 1e-6 * count, 1e-9);
    ASSERT_EQ(fields[2], "known");
    ASSERT_EQ(fields[11], "not_asked");
  }
  EXPECT_EQ(count, 10500);
}

TEST_F(QueryCommand, TakesBearingsAndRangesAndAnAntennaOfItsOwn) {
  const Outcome outcome =
      query({"--csv", "--range", "180,3000", "--antenna", "33.0,-99.5,1000", "--height-reference", "ground"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  const std::vector<std::string> fields = csv_fields(line);
  // sqrt(3000^2 - 1000^2) m south; a degree of latitude is 110,898 m at 33 N.
  EXPECT_NEAR(std::stod(fields[0]), 33 - 2828.427 / 110898, 2e-6) << line;
  EXPECT_EQ(fields[11], "visible");
}

TEST_F(QueryCommand, RefusesWhatItCannotAsk) {
  expect_refused({}, "found 0 of --at, --range and --points");
  expect_refused({"--at", "33"}, "--at: found 33; allowed: two or three numbers");
  expect_refused({"--at", "33,-99,nan", "--radar", "main"}, "height_m[0]: found nan");
  expect_refused({"--at", "33,-99,10", "--at", "33,-99", "--radar", "main"}, "heights for 1 of 2 points");
  expect_refused({"--at", "33,-99", "--radar", "tail"}, "main, nose");
  expect_refused({"--at", "133,-99", "--radar", "main"}, "latitude_deg[0]: found 133; allowed: -90 to 90");
  expect_refused({"--points", "nothing.csv", "--radar", "main"}, "nothing.csv cannot be read");
  expect_refused({"--points", folder.write("bad.csv", "33,-99\n33;-99\n"), "--radar", "main"},
                 "bad.csv:2: found");
  expect_refused({"--points", folder.write("other.txt", "1,s3cret\n"), "--radar", "main"},
                 "other.txt:1: found no point; allowed: two or three numbers");
  expect_refused({"--range", "10,5000", "--no-sight"}, "radar: found none");
  expect_refused({"--at", "33,-99", "--antenna", "33,-99"}, "--antenna: found no height");
  expect_refused({"--at", "33,-99", "--antenna", "33,-99.5,-50"}, "below the ground");
}

}  // namespace
}  // namespace obliq::test
