// Published settings, and settings as messages.
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"

namespace obliq {
namespace {

/// Settings that differ from the defaults in every field.
RadarConfig unlike_defaults() {
  RadarConfig c;
  c.settings = {35,
                60,
                100,
                9000,
                5,
                30,
                true,
                SpeckleKind::geometric,
                -9,
                FrustumKind::polar,
                PlateKind::nearest,
                3,
                4,
                17,
                5,
                6,
                ScanMode::sector,
                7,
                16,
                {},
                {BeamPattern::taylor, 2.5, 35, 5, 12, ElevationPattern::cosecant, 4, 25, nullptr},
                {PulseKind::compressed, 2, 3, PulseWindow::hann, 40, 6, 8, true},
                {true, 7, 500, 3, -8, ~0ULL, 20, 5000, 3.5, 40, 12, 10},
                {16, false, -90, 60},
                {16, 3000, true, Polarisation::vertical}};
  c.pose = {-33.25, 151.5, 777.125, HeightReference::ellipsoid, -12.5, 359, -4'000'000'000'000'000'000, ~0ULL,
            2.5,    -7.5,  true};
  return c;
}

TEST(SettingsMessage, EveryFieldSurvivesTheRoundTrip) {
  const RadarConfig sent = unlike_defaults();
  wire::RadarSettings settings;
  wire::Pose pose;
  write_message(sent.settings, settings);
  write_message(sent.pose, pose);
  wire::RadarSettings settings_received;
  wire::Pose pose_received;
  ASSERT_TRUE(settings_received.ParseFromString(settings.SerializeAsString()));
  ASSERT_TRUE(pose_received.ParseFromString(pose.SerializeAsString()));
  RadarConfig got;
  EXPECT_TRUE(merge_message(settings_received, got.settings).empty());
  EXPECT_TRUE(merge_message(pose_received, got.pose).empty());
  for (const Parameter& p : parameters()) {
    EXPECT_EQ(value_of(p, got), value_of(p, sent)) << p.key.name;
    EXPECT_NE(value_of(p, got), value_of(p, RadarConfig{})) << p.key.name;
  }
}

TEST(SettingsMessage, NumbersOfTheWireAreThoseOfTheProtocol) {
  // The enumerations of the program and of the wire count differently.
  wire::RadarSettings message;
  RadarSettings settings;
  settings.frustum = FrustumKind::symmetric;
  write_message(settings, message);
  EXPECT_EQ(message.frustum(), wire::SYMMETRIC);
  EXPECT_EQ(static_cast<int>(message.frustum()), 1);
  settings.frustum = FrustumKind::oblique;
  write_message(settings, message);
  EXPECT_EQ(static_cast<int>(message.frustum()), 0);
}

TEST(SettingsMessage, AbsentFieldsKeepTheirValueAndZeroIsAValue) {
  RadarSettings settings = unlike_defaults().settings;
  wire::RadarSettings message;
  message.set_gain_db(0);
  message.set_range_normalisation(false);
  EXPECT_TRUE(merge_message(message, settings).empty());
  EXPECT_EQ(settings.gain_db, 0);
  EXPECT_FALSE(settings.range_normalisation);
  EXPECT_EQ(settings.r_max_m, 9000);
  EXPECT_EQ(settings.frustum, FrustumKind::polar);
}

TEST(SettingsMessage, UnknownEnumeratorsAreRefusedByName) {
  // frustum is field 10: a varint with a number that no enumerator has.
  wire::RadarSettings message;
  ASSERT_TRUE(message.ParseFromString("\x50\x2a"));
  RadarSettings settings;
  const auto errors = merge_message(message, settings);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].field, "frustum.kind");
  EXPECT_EQ(errors[0].found, "42");
  EXPECT_EQ(errors[0].allowed, "\"symmetric\" | \"oblique\" | \"sweep\"");
  EXPECT_EQ(settings.frustum, FrustumKind::oblique);
}

TEST(SettingsStore, VersionsRiseAndSnapshotsStay) {
  SettingsStore store(RadarSettings{});
  const SettingsPtr first = store.current();
  EXPECT_EQ(first->version, 1u);
  RadarSettings changed;
  changed.r_max_m = 20000;
  const auto outcome = store.set(changed);
  ASSERT_TRUE(outcome.published);
  EXPECT_EQ(outcome.published->version, 2u);
  EXPECT_EQ(store.current(), outcome.published);
  EXPECT_EQ(first->settings.r_max_m, 37000);
}

TEST(SettingsStore, ARefusedChangeChangesNothing) {
  SettingsStore store(RadarSettings{});
  const SettingsPtr before = store.current();
  const auto outcome = store.update([](RadarSettings& s) {
    s.r_max_m = std::numeric_limits<double>::quiet_NaN();
    s.power_w = 7;
    return std::vector<FieldError>{};
  });
  EXPECT_FALSE(outcome.published);
  ASSERT_EQ(outcome.errors.size(), 1u);
  EXPECT_EQ(outcome.errors[0].field, "radar.r_max_m");
  EXPECT_EQ(store.current(), before);
  // Faults that the edit itself finds count as well.
  const auto own = store.update([](RadarSettings&) { return std::vector<FieldError>{{"x", "y", "z"}}; });
  EXPECT_FALSE(own.published);
  EXPECT_EQ(store.current(), before);
}

TEST(SettingsStore, KeepsARecordingsSettingsThoughTheyMakeNoFramesAnyMore) {
  RadarSettings recorded;
  recorded.frustum = FrustumKind::polar;
  SettingsStore store(recorded);
  EXPECT_EQ(store.current()->settings.frustum, FrustumKind::polar);
  EXPECT_FALSE(store.set(recorded).published);
}

TEST(SettingsStore, NoUpdateIsLostBetweenThreads) {
  constexpr int kThreads = 4;
  constexpr int kUpdates = 500;
  RadarSettings initial;
  initial.speckle_seed = 0;
  SettingsStore store(initial);
  std::atomic<bool> fell = false;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([&] {
        std::uint64_t last = 0;
        for (int i = 0; i < kUpdates; ++i) {
          (void)store.update([](RadarSettings& s) {
            ++s.speckle_seed;
            return std::vector<FieldError>{};
          });
          const std::uint64_t version = store.current()->version;
          if (version < last) fell = true;
          last = version;
        }
      });
  }
  EXPECT_FALSE(fell);
  EXPECT_EQ(store.current()->settings.speckle_seed, kThreads * kUpdates);
  EXPECT_EQ(store.current()->version, 1u + kThreads * kUpdates);
}

}  // namespace
}  // namespace obliq
