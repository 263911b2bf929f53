// The log of an exercise: who changed what, when; and that it says all of it.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "proto/bookmark.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/net/exercise/exercise_log.h"
#include "server/net/panel.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::events_test {
namespace {

using client::Status;
using net::ExerciseLog;
using wire::kPoseClaim;
using wire::kSettingsClaim;

constexpr const char* kRadars[] = {"main", "nose"};

std::vector<wire::ExerciseEvent> events_of(client::Client& client, std::uint64_t after = 0) {
  std::vector<wire::ExerciseEvent> events;
  wire::ExerciseEvents page;
  do {
    page.Clear();
    EXPECT_TRUE(is_ok(client.get_events(after, false, page)));
    events.insert(events.end(), page.events().begin(), page.events().end());
    if (!events.empty()) after = events.back().number();
  } while (page.more());
  return events;
}

/// "host" of "host (127.0.0.1:4711)".
std::string first_word(const std::string& name) { return name.substr(0, name.find(" (")); }

std::string words(const wire::ExerciseEvent& event) {
  wire::ExerciseEvent shown = event;
  shown.clear_number();
  shown.clear_utc_ns();
  shown.clear_state();
  shown.set_by(first_word(event.by()));
  if (!event.taken_from().empty()) shown.set_taken_from(first_word(event.taken_from()));
  return shown.ShortDebugString();
}

wire::RadarSettings gain(double db) {
  wire::RadarSettings settings;
  settings.set_receiver_gain_db(db);
  return settings;
}

wire::Pose tilt(double tilt_deg) {
  wire::Pose pose;
  pose.set_tilt_deg(tilt_deg);
  return pose;
}

/// How an exercise stands, in words: what GetExercise says, who holds what, whether all is stopped.
std::string standing(client::Client& client) {
  wire::ExerciseState state;
  EXPECT_TRUE(is_ok(client.get_exercise(state)));
  state.clear_request_id();
  std::string text = state.DebugString();
  const wire::Status status = status_of(client);
  for (const wire::RadarStatus& radar : status.radars())
    text += radar.radar() + ": " + first_word(radar.controller()) + ", " +
            first_word(radar.settings_controller()) + "\n";
  return text + (status.exercise_frozen() ? "frozen" : "");
}

class Events : public Served {
 protected:
  wire::Ack ack;
};

TEST_F(Events, EachChangeIsNotedOnceWithWhoAndWhat) {
  client::Client host = connect(server, "host");
  client::Client hand = connect(server, "hand");
  ASSERT_TRUE(is_ok(host.claim_control("main")));
  ASSERT_TRUE(is_ok(host.claim_control("main")));  // again: nothing has changed
  ASSERT_TRUE(is_ok(hand.claim("main", kSettingsClaim, true)));
  wire::Pose flown;
  flown.set_latitude_deg(0.5);
  flown.set_sim_time_ns(7'000'000'000);
  ASSERT_TRUE(is_ok(host.set_pose("main", flown, ack)));  // a pose of the flight
  ASSERT_TRUE(is_ok(hand.set_settings("main", gain(6), ack)));
  ASSERT_TRUE(is_ok(hand.set_settings("main", gain(6), ack)));
  ASSERT_TRUE(is_ok(hand.set_pose("main", tilt(-5), ack)));
  EXPECT_FALSE(hand.set_settings("main", gain(1e9), ack).ok());
  ASSERT_TRUE(is_ok(hand.set_state("main", false, std::nullopt)));
  ASSERT_TRUE(is_ok(hand.add_bookmark("wie schön")));
  ASSERT_TRUE(is_ok(hand.freeze_exercise(true)));
  ASSERT_TRUE(is_ok(hand.freeze_exercise(true)));
  ASSERT_TRUE(is_ok(hand.reset_exercise("nose")));
  ASSERT_TRUE(is_ok(hand.release_control("main")));
  net::PanelChange change;
  change.rate_limit_hz = 5;
  change.transmit = true;
  ASSERT_EQ(server.panel().change(0, change, std::chrono::seconds(60)).verdict, net::PanelVerdict::done);
  host.close();
  while (!status_of(client).radars(0).controller().empty()) {
  }
  const std::string at_7_s = " sim_time_ns: 7000000000";
  const std::vector<std::string> expected{
      R"(kind: CLAIM_EVENT by: "host" radar: "main" claims: POSE_CLAIM claims: SETTINGS_CLAIM)",
      R"(kind: TAKE_OVER_EVENT by: "hand" radar: "main" claims: SETTINGS_CLAIM taken_from: "host")",
      R"(kind: SETTINGS_EVENT by: "hand" radar: "main")" + at_7_s + " settings { receiver_gain_db: 6 }",
      R"(kind: AIM_EVENT by: "hand" radar: "main")" + at_7_s + " pose { tilt_deg: -5 }",
      R"(kind: SWITCH_EVENT by: "hand" radar: "main")" + at_7_s + " transmit: false",
      R"(kind: BOOKMARK_EVENT by: "hand")" + at_7_s + R"( text: "wie sch\303\266n")",
      R"(kind: FREEZE_EVENT by: "hand" freeze: true)",
      R"(kind: RESET_EVENT by: "hand" radar: "nose")",
      R"(kind: RELEASE_EVENT by: "hand" radar: "main")" + at_7_s + " claims: SETTINGS_CLAIM",
      R"(kind: SWITCH_EVENT by: "the operator\'s console" radar: "main")" + at_7_s +
          " transmit: true rate_limit_hz: 5",
      R"(kind: RELEASE_EVENT by: "host" radar: "main")" + at_7_s + " claims: POSE_CLAIM"};
  std::vector<std::string> found;
  std::uint64_t number = 0;
  for (const wire::ExerciseEvent& event : events_of(client)) {
    found.push_back(words(event));
    EXPECT_EQ(event.number(), ++number);
    EXPECT_GT(event.utc_ns(), 0);
    if (event.kind() == wire::RESET_EVENT) {
      ASSERT_EQ(event.state().radars_size(), 1) << "of what was reset";
      EXPECT_EQ(event.state().radars(0).radar(), "nose");
    }
  }
  EXPECT_EQ(found, expected);
}

/// Does at another server what an event says was done.
class Again {
 public:
  explicit Again(const TestServer& server) : server_(server) {}

  void apply(const wire::ExerciseEvent& event) {
    SCOPED_TRACE(words(event));
    client::Client& by = client_of(event.by());
    const std::string& radar = event.radar();
    wire::Ack ack;
    wire::ClaimSet claims = 0;
    for (const int kind : event.claims()) claims |= claim_bit(static_cast<wire::Claim>(kind));
    switch (event.kind()) {
      case wire::CLAIM_EVENT:
        return expect(by.claim(radar, claims));
      case wire::TAKE_OVER_EVENT:
        return expect(by.claim(radar, claims, true));
      case wire::RELEASE_EVENT:
        return expect(by.release(radar, claims));
      case wire::SETTINGS_EVENT:
        return expect(by.set_settings(radar, event.settings(), ack));
      case wire::AIM_EVENT:
        return expect(by.set_pose(radar, event.pose(), ack));
      case wire::SWITCH_EVENT:
        return expect(by.set_state(radar,
                                   event.has_transmit() ? std::optional(event.transmit()) : std::nullopt,
                                   event.has_freeze() ? std::optional(event.freeze()) : std::nullopt));
      case wire::RESET_EVENT:
        return expect(by.reset_exercise(radar));
      case wire::LOAD_EVENT:
        return expect(by.load_exercise(event.state()));
      case wire::FREEZE_EVENT:
        return expect(by.freeze_exercise(event.freeze()));
      case wire::BOOKMARK_EVENT:
        return expect(by.add_bookmark(event.text()));
      default:
        ADD_FAILURE() << "an event that says nothing";
    }
  }

 private:
  static void expect(const Status& status) { EXPECT_TRUE(is_ok(status)); }
  client::Client& client_of(const std::string& name) {
    const auto [at, fresh] = clients_.try_emplace(first_word(name));
    if (fresh) at->second = connect(server_, at->first);
    return at->second;
  }
  const TestServer& server_;
  std::map<std::string, client::Client> clients_;
};

/// Does something, allowed or not.
void do_anything(std::mt19937& random, client::Client& client, const wire::ExerciseState& saved) {
  const auto any = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const char* radar = kRadars[any(2)];
  wire::Ack ack;
  switch (any(12)) {
    case 0:
    case 1:
      return (void)client.claim(radar, static_cast<wire::ClaimSet>(1 + any(3)), any(3) == 0).ok();
    case 2:
      return (void)client.release(radar, static_cast<wire::ClaimSet>(1 + any(3))).ok();
    case 3:
    case 4:
    case 5: {
      wire::RadarSettings settings;
      if (any(2) == 0) settings.set_power_w(1 + any(5));
      if (any(3) == 0) settings.set_noise_seed(any(9) - 4);
      if (any(3) == 0) settings.set_azimuth_bins(8 + 8 * any(3));
      if (any(4) == 0) settings.set_frustum(any(2) == 0 ? wire::SWEEP : wire::OBLIQUE);
      if (any(4) == 0) settings.set_planes_per_bin(any(3));
      if (any(5) == 0) settings.set_pixel_columns(16 + 16 * any(3));
      if (any(4) == 0) settings.set_video_floor_db(-100 - any(5));
      if (any(4) == 0) settings.set_video_floor_auto(any(2) == 0);
      return (void)client.set_settings(radar, settings, ack).ok();
    }
    case 6:
    case 7: {
      wire::Pose pose;
      if (any(2) == 0) pose.set_tilt_deg(-any(8));
      if (any(3) == 0) pose.set_bearing_deg(any(90));
      if (any(4) == 0) pose.set_tilt_auto(any(2) == 0);
      return (void)client.set_pose(radar, pose, ack).ok();
    }
    case 8:
      return (void)client
          .set_state(radar, any(2) == 0 ? std::optional(any(2) == 0) : std::nullopt,
                     any(2) == 0 ? std::optional(any(2) == 0) : std::nullopt)
          .ok();
    case 9:
      return (void)client.freeze_exercise(any(2) == 0).ok();
    case 10:
      return (void)client.add_bookmark("at " + std::to_string(any(1000))).ok();
    default:
      if (any(3) == 0) return (void)client.load_exercise(saved).ok();
      if (any(3) == 0) return (void)client.reset_exercise(any(2) == 0 ? "" : radar).ok();
  }
}

TEST_F(Events, TheLogAppliedAnewGivesTheSameExerciseAndTheSameLog) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    const TestServer first;
    client::Client watcher = connect(first, "watcher");
    wire::ExerciseState saved;
    std::map<std::string, client::Client> crew;
    for (const char* name : {"host", "hand", "chief"}) crew[name] = connect(first, name);
    std::mt19937 random(seed);
    for (int step = 0; step < 300; ++step) {
      if (step == 100) {
        ASSERT_TRUE(is_ok(watcher.get_exercise(saved)));
      }
      do_anything(random, std::next(crew.begin(), static_cast<int>(random() % 3))->second, saved);
    }
    const std::vector<wire::ExerciseEvent> log = events_of(watcher);
    EXPECT_GT(log.size(), 60u);
    const TestServer second;
    client::Client other = connect(second, "watcher");
    Again again(second);
    for (const wire::ExerciseEvent& event : log) again.apply(event);
    EXPECT_EQ(standing(other), standing(watcher));
    std::vector<std::string> did, does;
    for (const wire::ExerciseEvent& event : log) did.push_back(words(event));
    for (const wire::ExerciseEvent& event : events_of(other)) does.push_back(words(event));
    EXPECT_EQ(does, did);
  }
}

/// Keeps what it receives.
struct Follower : client::FrameHandler {
  Status on_events(const wire::ExerciseEvents& more) override {
    heard.insert(heard.end(), more.events().begin(), more.events().end());
    return {};
  }
  std::vector<wire::ExerciseEvent> heard;
};

TEST_F(Events, WhoFollowsHearsEachEventOnceAndOthersNothing) {
  Follower follower, stranger;
  client::Client follows = connect(server, "follows");
  follows.set_handler(&follower);
  client.set_handler(&stranger);
  ASSERT_TRUE(is_ok(client.claim_control("main")));
  const std::string long_text(wire::kMaxBookmarkBytes, 'x');
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(is_ok(client.add_bookmark(long_text)));  // three pages
  wire::ExerciseEvents page;
  std::uint64_t after = 0;
  int pages = 0;
  do {
    page.Clear();
    ASSERT_TRUE(is_ok(follows.get_events(after, true, page, true)));
    follower.heard.insert(follower.heard.end(), page.events().begin(), page.events().end());
    after = page.events().rbegin()->number();
    EXPECT_EQ(page.has_state(), !page.more()) << "behind the last event";
    // Meanwhile: whether it comes with the next page or by itself, it comes once.
    ASSERT_TRUE(is_ok(client.set_settings("main", gain(++pages), ack)));
  } while (page.more());
  EXPECT_GT(pages, 2);
  ASSERT_TRUE(is_ok(client.release_control("main")));
  while (follower.heard.back().kind() != wire::RELEASE_EVENT) ASSERT_TRUE(is_ok(follows.receive(kLong)));
  std::uint64_t number = 0;
  for (const wire::ExerciseEvent& event : follower.heard) EXPECT_EQ(event.number(), ++number);
  EXPECT_EQ(number, events_of(client).size());
  (void)status_of(client);
  EXPECT_TRUE(stranger.heard.empty());
  // No longer.
  ASSERT_TRUE(is_ok(follows.get_events(number, false, page)));
  ASSERT_TRUE(is_ok(client.add_bookmark("unheard")));
  (void)status_of(follows);
  EXPECT_EQ(follower.heard.size(), number);
}

/// Past the client library, which refuses it itself.
wire::Error refusal_of(const TestServer& server, const std::string& text) {
  RawPeer raw(server);
  raw.send(hello_bytes());
  wire::AddBookmark request;
  request.set_request_id(9);
  request.set_text(text);
  raw.send(wire::encode_message(wire::MessageType::add_bookmark, {}, request, {}, 2'000'000));
  wire::Error error;
  EXPECT_TRUE(raw.await(wire::MessageType::error, error));
  return error;
}

TEST_F(Events, ABookmarkThatIsTooLongOrNoTextIsRefusedWithWhatIsAllowed) {
  const struct {
    std::string text, found;
  } cases[] = {{"", "0 bytes"},
               {std::string(wire::kMaxBookmarkBytes + 1, 'x'), "1001 bytes"},
               {std::string(200'000, 'x'), "200000 bytes"},
               {"a\nb", "a control character at byte 1"},
               {"\x1b[2J", "a control character at byte 0"},
               {"a\xc2\x9b", "a control character at byte 1"}};
  for (const auto& [text, found] : cases) {
    const wire::Error error = refusal_of(server, text);
    EXPECT_EQ(error.number(), number(wire::ErrorNumber::invalid_value));
    EXPECT_EQ(error.request_id(), 9u);
    ASSERT_EQ(error.fields_size(), 1);
    EXPECT_EQ(error.fields(0).field(), "text");
    EXPECT_EQ(error.fields(0).found(), found);
    EXPECT_EQ(error.fields(0).allowed(), "1 to 1000 bytes of text without control characters");
    const Status here = client.add_bookmark(text);
    EXPECT_NE(here.sentence().find("text: found " + found), std::string::npos) << here.sentence();
  }
  // A megabyte is more than any request's protobuf part may be.
  const wire::Error error = refusal_of(server, std::string(1'000'000, 'x'));
  EXPECT_EQ(error.number(), number(wire::ErrorNumber::bad_length)) << error.text();
  EXPECT_NE(error.text().find("1000"), std::string::npos) << error.text();
  EXPECT_NE(error.text().find("allowed"), std::string::npos) << error.text();
  EXPECT_NE(
      client.add_bookmark(std::string(1'000'000, 'x')).sentence().find("found 1000000 bytes; allowed: 1 to"),
      std::string::npos);
  EXPECT_TRUE(events_of(client).empty());
}

TEST_F(Events, AServerTakesSoManyBookmarksAndNoMore) {
  for (std::size_t i = 0; i < ExerciseLog::kMostBookmarks; ++i) ASSERT_TRUE(is_ok(client.add_bookmark("x")));
  const Status refused = client.add_bookmark("x");
  EXPECT_EQ(refused.number, number(wire::ErrorNumber::over_limit));
  EXPECT_NE(refused.sentence().find("found bookmark 1001; allowed: 1000"), std::string::npos)
      << refused.sentence();
  EXPECT_EQ(events_of(client).size(), ExerciseLog::kMostBookmarks);
}

}  // namespace
}  // namespace obliq::test::events_test
