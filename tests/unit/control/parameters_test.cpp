// The table of parameters against the structures and messages it speaks for, and validate() over it.
#include "server/control/parameters.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>

#include "proto/obliq.pb.h"
#include "server/control/parameter_reference.h"
#include "server/control/sections/section.h"

namespace obliq::parameters_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const void* address(const Slot& slot) {
  return std::visit([](const auto* place) { return static_cast<const void*>(place); }, slot);
}

bool mentions(const std::vector<FieldError>& errors, std::string_view field) {
  return std::ranges::any_of(errors, [&](const FieldError& e) { return e.field == field; });
}

/// What any member can be made of.
struct Anything {
  template <class T>
  operator T() const {
    return {};
  }
};

/// How many members an aggregate has.
template <class T, class... Some>
constexpr std::size_t members_of() {
  if constexpr (requires { T{Some{}..., Anything{}}; })
    return members_of<T, Some..., Anything>();
  else
    return sizeof...(Some);
}

template <class... Structures>
constexpr std::size_t members_in = (members_of<Structures>() + ...);

TEST(Parameters, EveryFieldOfTheStructuresIsInTheTableOnce) {
  RadarConfig config;
  std::set<const void*> covered;
  for (const Parameter& p : parameters())
    EXPECT_TRUE(covered.insert(address(p.slot(config))).second) << p.key.name;
  constexpr std::size_t kParts = 7;   // of RadarSettings that are structures
  constexpr std::size_t kOthers = 2;  // no message carries them: beam.file, and rows_beside_cells of tests
  EXPECT_EQ(covered.size() + kParts + kOthers,
            (members_in<RadarSettings, BeamSettings, PulseSettings, DopplerSettings, ReceiverSettings,
                        VideoSettings, AtmosphereSettings, SeaSettings, PoseSettings>))
      << "a new field wants a row in server/control/sections/*_parameters.cpp, a new part a place here";
}

TEST(Parameters, EveryFieldOfTheMessagesIsInTheTableOnce) {
  const auto covered = [](WireMessage message) {
    std::multiset<std::string> names;
    for (const Parameter& p : parameters())
      if (p.message == message) names.insert(std::string(p.wire_field));
    return names;
  };
  const auto fields = [](const google::protobuf::Descriptor* message) {
    std::multiset<std::string> names;
    for (int i = 0; i < message->field_count(); ++i) {
      names.insert(message->field(i)->name());
      EXPECT_TRUE(message->field(i)->has_presence()) << message->field(i)->full_name();
    }
    return names;
  };
  EXPECT_EQ(covered(WireMessage::radar_settings), fields(wire::RadarSettings::descriptor()));
  std::multiset<std::string> of_pose = fields(wire::Pose::descriptor());
  EXPECT_EQ(of_pose.erase("new_time_line"), 1u) << "of one SetPose alone: nothing that a radar has";
  EXPECT_EQ(covered(WireMessage::pose), of_pose);
}

TEST(Parameters, EveryEnumeratorOfTheMessagesHasAChoice) {
  for (const Parameter& p : parameters()) {
    const auto* message =
        p.message == WireMessage::pose ? wire::Pose::descriptor() : wire::RadarSettings::descriptor();
    const auto* enumeration = message->FindFieldByName(std::string(p.wire_field))->enum_type();
    if (enumeration == nullptr) {
      EXPECT_TRUE(p.key.choices.empty()) << p.key.name;
      continue;
    }
    ASSERT_EQ(static_cast<int>(p.key.choices.size()), enumeration->value_count()) << p.key.name;
    for (const Choice& choice : p.key.choices)
      EXPECT_NE(enumeration->FindValueByName(std::string(choice.wire_name)), nullptr) << choice.name;
  }
}

TEST(Parameters, KeysDifferAndCarrySummaries) {
  std::set<std::string_view> keys;
  for (const Parameter& p : parameters()) {
    EXPECT_TRUE(keys.insert(p.key.name).second) << p.key.name;
    EXPECT_EQ(find_parameter(p.key.name), &p);
    EXPECT_FALSE(p.key.summary.empty());
    EXPECT_EQ(p.key.summary.back(), '.') << p.key.name;
  }
  EXPECT_EQ(find_parameter("radar.colour"), nullptr);
}

TEST(Parameters, ThePageInTheRepositoryIsTheTable) {
  std::ifstream file(OBLIQ_PARAMETERS_PAGE);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), parameters_markdown()) << "run: cmake --build --preset release --target generated";
}

TEST(Parameters, TheJsonHasEveryKeyOfThePageWithItsDefaultAndUnit) {
  std::map<std::string, nlohmann::json> by_key;
  for (const auto& key : nlohmann::json::parse(parameters_json()))
    EXPECT_TRUE(by_key.emplace(key.at("key").get<std::string>(), key).second) << key;
  EXPECT_EQ(by_key.at("radar.r_max_m").at("limits"), nlohmann::json({{"above", 0.0}, {"at_most", 500e3}}));
  EXPECT_EQ(by_key.at("radar.r_max_m").at("message_field"), "RadarSettings.r_max_m");
  EXPECT_EQ(by_key.at("server.port").at("change"), "restart");
  std::ifstream page(OBLIQ_PARAMETERS_PAGE);
  std::size_t rows = 0;
  bool typed = false;  // whether the table has a column of types
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| key |")) typed = line.starts_with("| key | type |");
    if (!line.starts_with("| `") || line.find('.') > line.find('`', 3)) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 2, end; (end = line.find(" | ", at)) != std::string::npos; at = end + 3)
      cells.push_back(line.substr(at, end - at));
    const auto plain = [](std::string text) {
      std::erase(text, '`');
      return text;
    };
    ++rows;
    const std::string name = plain(cells.at(0));
    ASSERT_TRUE(by_key.contains(name)) << name;
    const nlohmann::json& key = by_key.at(name);
    const std::string text = plain(cells.at(typed ? 2 : 1));
    const auto value = nlohmann::json::parse(text, nullptr, false);
    EXPECT_EQ(key.at("default"), value.is_discarded() ? nlohmann::json(text) : value) << name;
    EXPECT_TRUE(cells.at(typed ? 3 : 2).ends_with(key.at("unit").get<std::string>())) << name;
  }
  // Those that stand for several parameters or in no message have paragraphs of their own.
  EXPECT_EQ(rows + radar_special_keys().size(), by_key.size());
}

TEST(Validate, DefaultsAreValid) { EXPECT_TRUE(validate(RadarConfig{}).empty()); }

TEST(Validate, NaNAndInfinityAreRefusedInEveryNumber) {
  for (const Parameter& p : parameters()) {
    RadarConfig config;
    const Slot slot = p.slot(config);
    double* const* number = std::get_if<double*>(&slot);
    if (number == nullptr) continue;
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
      **number = bad;
      const auto errors = validate(config);
      EXPECT_TRUE(mentions(errors, p.key.name)) << p.key.name << " = " << bad;
    }
  }
}

TEST(Validate, LimitsHoldToTheLastBit) {
  for (const Parameter& p : parameters()) {
    RadarConfig config;
    const Slot slot = p.slot(config);
    double* const* number = std::get_if<double*>(&slot);
    if (number == nullptr) continue;
    const auto refused = [&](double value) {
      **number = value;
      return mentions(validate(config), p.key.name) && check(p.key, slot).has_value();
    };
    const Limits& limits = p.key.limits;
    EXPECT_TRUE(refused(std::nextafter(limits.low, -kInfinity))) << p.key.name;
    EXPECT_TRUE(refused(std::nextafter(limits.high, kInfinity))) << p.key.name;
    **number = limits.low;
    EXPECT_EQ(check(p.key, slot).has_value(), limits.low_open) << p.key.name;
    **number = limits.high;
    EXPECT_EQ(check(p.key, slot).has_value(), limits.high_open) << p.key.name;
  }
}

TEST(Validate, RangesMustRise) {
  RadarSettings s;
  for (const double r_min : {s.r_max_m, s.r_max_m + 1, 400e3}) {
    s.r_min_m = r_min;
    EXPECT_TRUE(mentions(validate(s), "radar.r_min_m")) << r_min;
  }
  s.r_min_m = std::nextafter(s.r_max_m, 0);
  EXPECT_TRUE(mentions(validate(s), "bins.range"));  // rising, but in bins of nanometres
  s.r_min_m = s.r_max_m - 1.1;                       // 1.07 mm bins
  EXPECT_TRUE(validate(s).empty());
}

TEST(Validate, StcMayEndBeyondTheDisplaysRangeAndAConverterHasTwoBits) {
  RadarSettings s;
  s.receiver.stc_range_m = 2 * s.r_max_m;  // another range scale leaves the knob alone
  s.receiver.adc_bits = 2;
  EXPECT_TRUE(validate(s).empty());
  s.receiver.adc_bits = 1;
  const auto errors = validate(s);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].text(), "receiver.adc_bits: found 1; allowed: 0 (no converter) or 2 to 16");
}

TEST(Validate, TheSymmetricFrustumNeedsLessThanHalfACircle) {
  RadarSettings s;
  s.frustum = FrustumKind::symmetric;
  s.sector_deg = 179.999;
  EXPECT_TRUE(validate(s).empty());
  s.sector_deg = 180;
  const auto errors = validate(s);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].field, "radar.sector_deg");
  EXPECT_NE(errors[0].allowed.find("\"oblique\" or \"sweep\""), std::string::npos);
  s.sector_deg = 360;
  for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::sweep}) {
    s.frustum = kind;
    EXPECT_TRUE(validate(s).empty());
  }
}

TEST(Validate, EverythingWrongIsToldAtOnce) {
  RadarConfig config;
  config.settings.sector_deg = 0;
  config.settings.pixel_rows = 0;
  config.settings.range_bins = 100000;
  config.settings.frustum = static_cast<FrustumKind>(77);
  config.pose.latitude_deg = 91;
  const auto errors = validate(config);
  EXPECT_EQ(errors.size(), 5u);
  for (const auto field :
       {"radar.sector_deg", "frustum.pixel_rows", "bins.range", "frustum.kind", "antenna.latitude_deg"})
    EXPECT_TRUE(mentions(errors, field)) << field;
}

TEST(Validate, AcceptsExactlyWhatIsInsideAllLimits) {
  // Random values, in and out of limits: an independent reading of the table decides which.
  std::mt19937_64 random(20240601);
  int valid = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    RadarConfig config;
    bool good = true;
    for (const Parameter& p : parameters()) {
      const Slot slot = p.slot(config);
      const double low = p.key.limits.low;
      const double high = p.key.limits.high;
      const bool outside = random() % 60 == 0;
      if (double* const* number = std::get_if<double*>(&slot)) {
        const double u = static_cast<double>(random() >> 11) * 0x1p-53;
        **number = outside ? high + (1 + u) * (1 + std::abs(high)) : low + (0.001 + 0.998 * u) * (high - low);
        good = good && !outside;
      } else if (int* const* integer = std::get_if<int*>(&slot)) {
        const int span = static_cast<int>(high - low);
        **integer =
            outside ? static_cast<int>(low) - 1
                    : static_cast<int>(low) + static_cast<int>(random() % static_cast<unsigned>(span + 1));
        good = good && !outside;
      }
    }
    config.settings.frustum = static_cast<FrustumKind>(random() % 4);
    int& dwell = config.settings.scan_dwell_bins;
    if (dwell > 8) dwell -= dwell % 8;
    ReceiverSettings& receiver = config.settings.receiver;
    if (receiver.adc_bits == 1) receiver.adc_bits = 2;
    const RadarSettings& s = config.settings;
    if (int& planes = config.settings.planes_per_bin; planes <= 1024 && s.azimuth_bins > 0)
      planes = std::min(planes, (16384 + s.azimuth_bins - 1) / s.azimuth_bins);
    good = good && s.r_max_m - s.r_min_m >= 0.001 * s.range_bins;
    good = good && s.frustum != FrustumKind::polar;  // recordings alone have it
    good = good && !(s.frustum == FrustumKind::symmetric && s.sector_deg >= 180);
    EXPECT_EQ(validate(config).empty(), good) << "trial " << trial;
    valid += good ? 1 : 0;
  }
  EXPECT_GT(valid, 400);
  EXPECT_LT(valid, 3600);
}

}  // namespace
}  // namespace obliq::parameters_test
