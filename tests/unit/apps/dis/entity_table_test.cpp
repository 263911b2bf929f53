// Which entities an exercise has, and what the server must hear of them.
#include "server/apps/dis/entity_table.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/unit/apps/dis/dis_fixture.h"

namespace obliq::test::entity_table_test {
namespace {

using Time = EntityTable::Time;
using What = SimulationOrder::What;

constexpr EntityId kAll{65535, 65535, 65535};

class Entities : public testing::Test {
 protected:
  Time at(double seconds) const {
    return Time{std::chrono::hours(1)} +
           std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds));
  }
  void take(const EntityState& state, double seconds) { table.take(state, at(seconds), at(seconds)); }
  EntityTable::Changes changes(double seconds) { return table.changes(at(seconds), centre_m); }
  static EntityState moving(std::uint16_t number = 1) {
    EntityState state = entity(number);
    state.velocity_m_s = {100, 0, 0};
    return state;
  }
  /// Of the only one that has changed, how far it is from where the PDU had it.
  double metres(double seconds) {
    const EntityTable::Changes found = changes(seconds);
    EXPECT_EQ(found.set.size(), 1u);
    return found.set.empty() ? -1
                             : glm::distance(found.set[0].motion.location_m, found.set[0].state.location_m);
  }

  EntityTable table{{}};
  std::optional<glm::dvec3> centre_m;
};

TEST_F(Entities, AreSentWhenTheyChangeAndAgainBeforeTheyAreForgotten) {
  EXPECT_TRUE(changes(0).empty());
  take(moving(), 0);
  EXPECT_NEAR(metres(0.5), 50, 1e-6);
  EXPECT_TRUE(changes(1).empty());
  EXPECT_TRUE(changes(4.4).empty());
  EXPECT_NEAR(metres(4.6), 460, 1e-6);
  take(moving(), 5);
  EXPECT_NEAR(metres(5), 0, 1e-6);
  table.forget_sent();
  EXPECT_NEAR(metres(6), 100, 1e-6);
}

TEST_F(Entities, OnCurvesAreSentAnewAtTheRefreshRate) {
  EntityState state = moving();
  state.dead_reckoning = 7;
  state.turn_rad_s = {0, 0, 0.1};
  take(state, 0);
  int sent = 0;
  for (int k = 0; k <= 40; ++k) sent += changes(0.05 * k).set.empty() ? 0 : 1;
  EXPECT_NEAR(sent, 11, 1) << "5 a second for 2 s";
}

TEST_F(Entities, GoTwelveSecondsAfterTheirLastPdu) {
  take(moving(1), 0);
  EntityState standing = entity(2);
  take(standing, 0);
  standing.id.entity = 3;
  standing.velocity_m_s = {100, 0, 0};
  standing.frozen = true;
  take(standing, 0);
  changes(0);
  EXPECT_TRUE(changes(11.9).gone.empty());
  EXPECT_EQ(changes(12.1).gone, std::vector<EntityId>{(EntityId{1, 2, 1})});
  EXPECT_EQ(table.size(), 2u);
  EXPECT_TRUE(changes(143.9).gone.empty());
  EXPECT_EQ(changes(144.1).gone.size(), 2u);
  EXPECT_EQ(table.size(), 0u);
}

TEST_F(Entities, GoAfterTheTimeoutThatIsAskedFor) {
  table = EntityTable({.timeout_s = 3});
  take(moving(1), 0);
  take(entity(2), 0);
  changes(0);
  EXPECT_TRUE(changes(2.9).gone.empty());
  EXPECT_EQ(changes(3.1).gone.size(), 2u);
}

TEST_F(Entities, GoAtOnceWhenTheyAreDeactivatedOrRemoved) {
  for (std::uint16_t number = 1; number <= 4; ++number) take(moving(number), 0);
  changes(0);
  EntityState left = moving(1);
  left.active = false;
  take(left, 1);
  EXPECT_EQ(changes(1).gone, std::vector<EntityId>{(EntityId{1, 2, 1})});
  table.obey({What::remove, 0, {1, 2, 3}}, at(1));
  EXPECT_EQ(changes(1.1).gone, std::vector<EntityId>{(EntityId{1, 2, 3})});
  table.obey({What::remove, 0, kAll}, at(2));
  EXPECT_EQ(changes(2).gone.size(), 2u);
  // One that comes back between two looks has not gone.
  take(moving(1), 3);
  changes(3);
  take(left, 3.1);
  take(moving(1), 3.2);
  const EntityTable::Changes found = changes(3.3);
  EXPECT_TRUE(found.gone.empty());
  EXPECT_EQ(found.set.size(), 1u);
}

TEST_F(Entities, OfTheOwnshipAreNone) {
  table = EntityTable({.ownship = EntityId{1, 2, 1}});
  take(moving(1), 0);
  take(moving(2), 0);
  EXPECT_EQ(changes(0).set.size(), 1u);
}

TEST_F(Entities, StandWhileTheyAreStoppedAndGoOnFromThere) {
  take(moving(), 0);
  changes(0);
  table.obey({What::stop, 0, kAll}, at(2));
  EXPECT_NEAR(metres(3), 200, 1e-6);
  EXPECT_NEAR(metres(30), 200, 1e-6) << "does not time out";
  // A PDU that comes meanwhile says where it stands; so does that of one that is new.
  take(moving(), 31);
  EXPECT_NEAR(metres(40), 0, 1e-6);
  take(moving(2), 41);
  const EntityTable::Changes fresh = changes(43);
  ASSERT_EQ(fresh.set.size(), 1u);
  EXPECT_EQ(fresh.set[0].motion.velocity_m_s, glm::dvec3(0.0));
  EXPECT_EQ(fresh.set[0].motion.location_m, fresh.set[0].state.location_m);
  table.obey({What::go_on, 0, kAll}, at(50));
  const EntityTable::Changes found = changes(51);
  ASSERT_EQ(found.set.size(), 2u);
  for (const EntityTable::Moving& one : found.set)
    EXPECT_NEAR(glm::distance(one.motion.location_m, one.state.location_m), 100, 1e-6);
}

TEST_F(Entities, ArePutWhereTheNewestPduSays) {
  take(moving(), 10);
  changes(10);
  EntityState old = moving();
  old.location_m.x += 1000;
  table.take(old, at(9.9), at(10.1));  // overtaken
  EXPECT_EQ(table.overtaken(), 1u);
  EXPECT_TRUE(changes(10.2).empty());
  table.take(old, at(7), at(10.3));  // its sender's clock was set back
  EXPECT_EQ(changes(10.3).set.size(), 1u);
}

TEST_F(Entities, ThatAreTooManyAreLeftOutFromAfar) {
  table = EntityTable({.most = 3});
  centre_m = entity().location_m;
  const auto put = [&](std::uint16_t number, double away_m, double seconds) {
    EntityState state = entity(number);
    state.location_m.x += away_m;
    take(state, seconds);
  };
  for (std::uint16_t number = 1; number <= 3; ++number) put(number, 100.0 * number, 0);
  EXPECT_EQ(changes(0).set.size(), 3u);
  EXPECT_EQ(table.left_out(), 0u);
  put(4, 50, 1);
  const EntityTable::Changes found = changes(2);
  EXPECT_EQ(table.left_out(), 1u);
  EXPECT_EQ(found.gone, std::vector<EntityId>{(EntityId{1, 2, 3})});
  ASSERT_EQ(found.set.size(), 1u);
  EXPECT_EQ(found.set[0].state.id.entity, 4);
  table.obey({What::remove, 0, {1, 2, 1}}, at(3));
  const EntityTable::Changes later = changes(3.1);
  EXPECT_EQ(table.left_out(), 0u);
  EXPECT_EQ(later.gone, std::vector<EntityId>{(EntityId{1, 2, 1})});
  ASSERT_EQ(later.set.size(), 1u);
  EXPECT_EQ(later.set[0].state.id.entity, 3);
}

}  // namespace
}  // namespace obliq::test::entity_table_test
