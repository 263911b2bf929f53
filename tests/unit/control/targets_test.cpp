// [[target]] and [target_types.NAME]: what a file means, what a printed one reads back as, and how mistakes
// are answered.
#include "server/control/sections/targets.h"

#include "proto/obliq.pb.h"
#include "server/control/target_message.h"
#include "tests/unit/control/scene_file_fixture.h"

namespace obliq::targets_test {
namespace {

const std::string kShip =
    "[target_types.ship]\nrcs_dbsm = 45\nswerling = 2\nlength_m = 120\nwidth_m = 20\ntop_m = 15\n";
const std::string kPlace = "latitude_deg = 33.1\nlongitude_deg = -99.4\n";

using Targets = SceneFile;

TEST_F(Targets, HaveWhatTheirTypeSaysAndTheyThemselves) {
  const SceneConfig config =
      read(kFlat + kShip + "[targets]\nseed = 9\n[[target]]\nname = \"one\"\ntype = \"ship\"\n" + kPlace +
           "velocity_north_m_s = \"10kt\"\nheading_deg = 20\n[[target]]\nname = \"two\"\n" +
           "type = \"ship\"\nrcs_dbsm = 30\nheight_reference = \"datum\"\nheight_m = 500\n" + kPlace);
  const TargetsPtr set = targets_of(config);
  ASSERT_EQ(set->targets.size(), 2u);
  EXPECT_EQ(set->seed, 9);
  const Target& one = set->targets[0];
  EXPECT_EQ(one.id, 1u);
  EXPECT_EQ(one.size, (TargetSize{45, 2, 120, 20, 15}));
  EXPECT_EQ(one.height_reference, HeightReference::ground);
  EXPECT_NEAR(one.velocity_m_s.z, 10 * 1852.0 / 3600, 1e-12);
  EXPECT_EQ(one.heading_deg, 20);
  const Target& two = set->targets[1];
  EXPECT_EQ(two.id, 2u);
  EXPECT_EQ(two.size, (TargetSize{30, 2, 120, 20, 15}));
  EXPECT_FALSE(two.heading_deg);
  EXPECT_EQ(two.height_m, 500);
  EXPECT_EQ(targets_of(read(kFlat)), nullptr);
}

TEST_F(Targets, TypesHavePatternsOfDis) {
  const SceneConfig config =
      read(kFlat + kShip + "dis = [\"1.3.225.6\", \"1.3.*.50\"]\n[target_types.boat]\ndis = \"1.3\"\n");
  ASSERT_EQ(config.target_types.size(), 2u);
  EXPECT_EQ(config.target_types[0].dis, std::vector<std::string>{"1.3"});
  EXPECT_EQ(config.target_types[1].dis, (std::vector<std::string>{"1.3.225.6", "1.3.*.50"}));
  const SceneConfig again = read(print_config(config));
  EXPECT_EQ(again.target_types[1].dis, config.target_types[1].dis);
  EXPECT_EQ(again.target_types[1].size, config.target_types[1].size);
  wire::TargetType message;
  write_message(config.target_types[1], message);
  ASSERT_EQ(message.dis_size(), 2);
  EXPECT_EQ(message.dis(1), "1.3.*.50");
  for (const char* none : {"\"1.3.x\"", "\"\"", "[\"1.3\", \"1.3.225.256\"]", "\"1.3.225.1.1.1.1.1\""})
    EXPECT_SAYS(complaint(kFlat + kShip + "dis = " + none + "\n"), "target_types.ship.dis") << none;
  EXPECT_SAYS(complaint(kFlat + kShip + "dis = [\"1.3.70000\"]\n"), "such as \"1.1.225.7\"");
  EXPECT_SAYS(complaint(kFlat + kShip + "dis = 13\n"), "target_types.ship.dis");
}

TEST_F(Targets, OfAPrintedSceneAreTheSame) {
  const SceneConfig config =
      read(kFlat + kShip + "[[target]]\nname = \"one\"\ntype = \"ship\"\n" + kPlace +
           "acceleration_up_m_s2 = 0.1\nsim_time_ns = -5\n[[target]]\nname = \"two\"\n" +
           "type = \"ship\"\nheading_deg = 90\ntop_m = 3\n" + kPlace);
  const SceneConfig again = read(print_config(config));
  ASSERT_EQ(again.targets.size(), config.targets.size());
  for (std::size_t k = 0; k < config.targets.size(); ++k) {
    EXPECT_EQ(again.targets[k].name, config.targets[k].name);
    EXPECT_EQ(again.targets[k].type, config.targets[k].type);
    EXPECT_EQ(again.targets[k].target, config.targets[k].target) << k;
  }
}

TEST_F(Targets, WithMistakesAreRefusedByName) {
  const std::string target = "[[target]]\nname = \"one\"\ntype = \"ship\"\n";
  EXPECT_SAYS(complaint(kFlat + kShip + "[[target]]\nname = \"one\"\ntype = \"tank\"\n" + kPlace),
              "target.type");
  EXPECT_SAYS(complaint(kFlat + kShip + "[[target]]\nname = \"one\"\ntype = \"tank\"\n" + kPlace),
              "one of \"ship\"");
  EXPECT_SAYS(complaint(kFlat + kShip + "[[target]]\nname = \"one\"\n" + kPlace), "target.type");
  EXPECT_SAYS(complaint(kFlat + kShip + target + "latitude_deg = 33\n"), "target.longitude_deg");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + "velocity_up_m_s = 20001\n"),
              "target.velocity_up_m_s");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + "swerling = 5\n"), "0 to 4");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + "rcs_dbsm = nan\n"), "target.rcs_dbsm");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + target + kPlace), "a second \"one\"");
  EXPECT_SAYS(complaint(kFlat + kShip + "[[target]]\ntype = \"ship\"\n" + kPlace), "target.name");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + "height_reference = \"ellipsoid\"\n"),
              "target.geoid_undulation_m");
  EXPECT_SAYS(complaint(kFlat + kShip + "rcs = 3\n"), "target_types.ship.rcs");
  EXPECT_SAYS(complaint(kFlat + kShip + target + kPlace + "heading = 3\n"), "target.heading_deg");
  EXPECT_SAYS(complaint(std::string(kFlat) + "target_types = 3\n"), "target_types");
}

}  // namespace
}  // namespace obliq::targets_test
