// Settings and poses as messages, and as published snapshots.
#include "server/control/settings_message.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <type_traits>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"

namespace obliq::settings_message_test {
namespace {

/// Another value within the limits than the parameter has there: the end of its type or limits that is
/// further away, the last of the choices or the first, the other truth.
void set_otherwise(const Parameter& p, RadarConfig& config) {
  const Limits& limits = p.key.limits;
  const auto far = [&](double value) {
    return std::abs(limits.high - value) < std::abs(value - limits.low) ? limits.low : limits.high;
  };
  std::visit(
      [&](auto* place) {
        using T = std::remove_pointer_t<decltype(place)>;
        if constexpr (std::is_same_v<T, bool>)
          *place = !*place;
        else if constexpr (std::is_enum_v<T>)
          *place = static_cast<T>(*place == T{} ? p.key.choices.size() - 1 : 0);
        else if constexpr (std::is_same_v<T, double>)
          *place = far(*place) / 3 + *place * 2 / 3;  // with all its bits
        else if constexpr (std::is_same_v<T, std::optional<double>>)
          *place = limits.high / 3;
        else if constexpr (std::is_same_v<T, std::vector<double>>)
          *place = {limits.low, limits.high / 3};
        else if constexpr (std::is_integral_v<T>)
          *place = std::isfinite(limits.high) ? static_cast<T>(far(static_cast<double>(*place)))
                   : std::is_signed_v<T>      ? std::numeric_limits<T>::min()
                                              : std::numeric_limits<T>::max();
        else
          FAIL() << p.key.name << ": of a type that no message has";
      },
      p.slot(config));
}

/// Settings that differ from the defaults in every field.
RadarConfig unlike_defaults() {
  RadarConfig config;
  for (const Parameter& p : parameters()) set_otherwise(p, config);
  return config;
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
  const RadarSettings before = unlike_defaults().settings;
  RadarSettings settings = before;
  wire::RadarSettings message;
  message.set_gain_db(0);
  message.set_range_normalisation(false);
  EXPECT_TRUE(merge_message(message, settings).empty());
  EXPECT_EQ(settings.gain_db, 0);
  EXPECT_FALSE(settings.range_normalisation);
  EXPECT_EQ(settings.r_max_m, before.r_max_m);
  EXPECT_EQ(settings.frustum, before.frustum);
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

TEST(SettingsMessage, AnIdealMapHasNothingButItsEchoes) {
  EXPECT_TRUE(is_ideal(wire::RadarSettings{}));  // of a server that knew no receiver
  const auto ideal_otherwise = [](const Parameter& p) {
    RadarConfig config;
    set_otherwise(p, config);
    wire::RadarSettings message;
    write_message(config.settings, message);
    return is_ideal(message);
  };
  for (const Parameter& p : parameters()) EXPECT_EQ(ideal_otherwise(p), !p.meaning.not_ideal) << p.key.name;
  // What adds to the echoes, spreads them, or changes their law in range.
  for (const auto* name : {"radar.mode", "beam.pattern", "beam.elevation", "pulse.kind", "receiver.noise",
                           "receiver.stc_range_m", "receiver.adc_bits", "atmosphere.rain_mm_h"})
    EXPECT_FALSE(ideal_otherwise(*find_parameter(name))) << name;
  // beam_pattern is field 20: a pattern of a later version.
  wire::RadarSettings unknown;
  ASSERT_TRUE(unknown.ParseFromString("\xa0\x01\x2a"));
  EXPECT_FALSE(is_ideal(unknown));
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
}  // namespace obliq::settings_message_test
