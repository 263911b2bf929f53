// The log of an exercise in a recording, from a real daemon; bookmarks of a debrief.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include "client/recording/recorded_events.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/record_fixture.h"
#include "tests/support/made_recording.h"

namespace obliq::test::record_events_test {
namespace {

std::vector<wire::ExerciseEvent> recorded_events(const std::string& file) {
  std::vector<wire::ExerciseEvent> events;
  client::RecordedLog log;
  EXPECT_TRUE(is_ok(client::read_events(
      file,
      [&](const wire::ExerciseEvents& more) {
        events.insert(events.end(), more.events().begin(), more.events().end());
      },
      log)));
  return events;
}

std::vector<wire::ExerciseEvent> bookmarks_of(client::Client& client) {
  wire::ExerciseEvents page;
  EXPECT_TRUE(is_ok(client.get_events(0, false, page)));
  std::vector<wire::ExerciseEvent> found;
  for (const wire::ExerciseEvent& event : page.events())
    if (event.kind() == wire::BOOKMARK_EVENT) found.push_back(event);
  return found;
}

class RecordEvents : public RecordTest {
 protected:
  /// Frames at every 0.1 s, and bookmarks at 2.05 s, 0.55 s and behind the end.
  std::string made_log() const {
    MadeRecording recording = timed_recording(40, 100'000'000);
    wire::ExerciseEvents events;
    int number = 70;  // as a server counts that has run for a while
    for (const double at_s : {2.05, 0.55, 1e6}) {
      wire::ExerciseEvent& event = *events.add_events();
      event.set_kind(wire::BOOKMARK_EVENT);
      event.set_number(static_cast<std::uint64_t>(++number));
      event.set_utc_ns(kMadeStart_ns + static_cast<std::int64_t>(1e9 * at_s));
      event.set_by("teacher");
      event.set_text("at " + std::to_string(at_s));
    }
    recording.add(wire::encode_message(wire::MessageType::exercise_events, {}, events),
                  wire::MessageType::exercise_events);
    return folder.write("log.obliq", recording.bytes);
  }
};

TEST_F(RecordEvents, ARecordingHasWhatWasDoneMeanwhileAndReplaysAsBefore) {
  const Daemon daemon({"--config", scene}, folder.path());
  client::Client client = connected(daemon.address(), "hand");
  wire::Ack ack;
  wire::RadarSettings settings;
  ASSERT_TRUE(is_ok(client.add_bookmark("before the recording")));
  Running recorder(record(daemon.address(), {"--out", file}), folder / "record.log");
  await_size(file, 60'000, recorder);
  ASSERT_TRUE(is_ok(client.claim_control("main")));
  settings.set_receiver_gain_db(6);
  ASSERT_TRUE(is_ok(client.set_settings("main", settings, ack)));
  settings.set_receiver_gain_db(1e9);
  EXPECT_FALSE(client.set_settings("main", settings, ack).ok());
  ASSERT_TRUE(is_ok(client.add_bookmark("here: \"shadow\"")));
  ASSERT_TRUE(is_ok(client.reset_exercise("main")));
  const std::uintmax_t by_now = std::filesystem::file_size(file);
  await_size(file, by_now + 60'000, recorder);
  ASSERT_EQ(recorder.end(SIGINT), 0) << recorder.log();

  const auto events = recorded_events(file);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0].kind(), wire::CLAIM_EVENT);
  EXPECT_EQ(events[1].settings().receiver_gain_db(), 6);
  EXPECT_EQ(events[2].text(), "here: \"shadow\"");
  EXPECT_EQ(events[3].kind(), wire::RESET_EVENT);
  const Outcome table = obliq({"replay", file, "--events"});
  ASSERT_EQ(table.code, 0) << table.err;
  for (const char* part : {"claims pose and settings", "sets receiver.gain_db = 6.0",
                           "bookmark: here: \"shadow\"", "resets to the scene file", ": 4 events"})
    EXPECT_NE(table.out.find(part), std::string::npos) << part << "\nin: " << table.out;
  EXPECT_EQ(table.out.find("before the recording"), std::string::npos);
  const Outcome json = obliq({"replay", file, "--events", "--json"});
  EXPECT_EQ(std::ranges::count(json.out, '\n'), 4) << json.out;
  EXPECT_NE(json.out.find("\"settings\":{\"receiver_gain_db\":6"), std::string::npos) << json.out;
  // Who knows no events skips them.
  const Outcome replayed = obliq({"replay", file, "--speed", "max"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_NE(replayed.out.find("nothing left over"), std::string::npos) << replayed.out;
}

TEST_F(RecordEvents, AStationTakesAllToABookmarkOfTheRecording) {
  Running replay({"replay", made_log(), "--serve", "--hold", "--port", "0"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  client::Client one = connected(address, "one");
  client::Client other = connected(address, "other");
  const auto marks = bookmarks_of(one);
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[0].by(), "teacher");
  wire::SetReplay request;
  request.set_paused(true);
  const auto go = [&](std::uint64_t number, double at_s) {
    request.set_seek_bookmark(number);
    ASSERT_TRUE(is_ok(one.set_replay(request)));
    (void)bookmarks_of(other);  // what was sent before has come
    EXPECT_NEAR(other.replay_state()->position_s(), at_s, 1e-6);
  };
  go(marks[0].number(), 2.05);
  go(marks[1].number(), 0.55);
  go(marks[2].number(), other.replay_state()->duration_s());
  EXPECT_EQ(obliq({"bookmark", "--server", address, "--go", "1"}).code, 0);
  const Outcome listed = obliq({"bookmark", "--server", address, "--list"});
  EXPECT_NE(listed.out.find("     2.050      1  "), std::string::npos) << listed.out;
  request.set_seek_bookmark(17);
  const client::Status refused = one.set_replay(request);
  EXPECT_NE(refused.sentence().find("seek_bookmark: found 17; allowed: the number of an event"),
            std::string::npos)
      << refused.sentence();
  request.set_seek_s(1);
  EXPECT_NE(one.set_replay(request).sentence().find("beside another place"), std::string::npos);
}

TEST_F(RecordEvents, ABookmarkOfADebriefIsAtItsPlaceAndKeptIfThatIsAskedFor) {
  const std::string path = made_log();
  const auto size = std::filesystem::file_size(path);
  for (const bool keeps : {false, true}) {
    std::vector<std::string> words{"replay", path, "--serve", "--hold", "--port", "0"};
    if (keeps) words.emplace_back("--keep-bookmarks");
    Running replay(words, folder / (keeps ? "keeps.log" : "replay.log"));
    client::Client client = connected(replay.await(" on "), "teacher");
    wire::SetReplay request;
    request.set_paused(true);
    request.set_seek_s(3.05);
    ASSERT_TRUE(is_ok(client.set_replay(request)));
    ASSERT_TRUE(is_ok(client.add_bookmark("look again")));
    const auto marks = bookmarks_of(client);
    ASSERT_EQ(marks.size(), 4u);
    EXPECT_EQ(marks[3].utc_ns(), kMadeStart_ns + 3'050'000'000);
    EXPECT_EQ(recorded_events(path).size(), keeps ? 4u : 3u);
    EXPECT_EQ(std::filesystem::file_size(path) > size, keeps);
  }
  EXPECT_EQ(recorded_events(path)[3].text(), "look again");
  const Outcome whole = obliq({"replay", path, "--speed", "max"});
  EXPECT_EQ(whole.code, 0) << whole.err;
}

TEST_F(RecordEvents, ALogThatIsDamagedAnywhereNeverCrashesAndLosesWhatIsDamagedAlone) {
  const std::string good = text_of(made_log());
  const std::string path = folder / "bad.obliq";
  const auto write = [&](const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; };
  for (std::size_t cut = good.size() - 1; cut > good.size() - 400; cut -= 7) {
    write(good.substr(0, cut));
    client::RecordedLog log;
    std::size_t events = 0;
    ASSERT_TRUE(is_ok(client::read_events(
        path,
        [&](const wire::ExerciseEvents& more) { events += static_cast<std::size_t>(more.events_size()); },
        log)));
    EXPECT_EQ(events, 0u) << cut;
  }
  // A byte in each of many places: the events come, unless it is theirs.
  for (std::size_t at = 3; at < good.size(); at += good.size() / 199) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x5a);
    write(bad);
    client::RecordedLog log;
    std::size_t events = 0;
    ASSERT_TRUE(is_ok(client::read_events(
        path,
        [&](const wire::ExerciseEvents& more) { events += static_cast<std::size_t>(more.events_size()); },
        log)));
    if (at + 1000 < good.size()) {
      EXPECT_EQ(events, 3u) << at;
    }
  }
  EXPECT_EQ(
      obliq({"replay", folder.write("text.obliq", "this is no recording, but it is long enough for a header"),
             "--events"})
          .code,
      1);
  EXPECT_EQ(obliq({"replay", folder / "missing.obliq", "--events"}).code, 1);
  // Behind a cut nothing is written.
  write(good.substr(0, good.size() - 5));
  wire::ExerciseEvents one;
  one.add_events()->set_kind(wire::BOOKMARK_EVENT);
  EXPECT_NE(client::append_events(path, one).sentence().find("its end is cut"), std::string::npos);
  EXPECT_EQ(text_of(path).size(), good.size() - 5);
}

TEST_F(RecordEvents, AllRadarsOfAServerAreInStepInOneRecording) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::vector<std::string> all{"record", "--server", daemon.address(), "--all",
                                     "--rate", "20",       "--out"};
  Outcome outcome = obliq(all, {file, "--frames", "4"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("radars main, nose"), std::string::npos) << outcome.out;
  std::map<std::string, client::RecordingStart> starts;
  for (const std::string radar : {"main", "nose"}) {
    std::unique_ptr<client::RecordingReader> reader;
    ASSERT_TRUE(is_ok(client::RecordingReader::open(file, reader)));
    ASSERT_TRUE(is_ok(client::read_start(*reader, radar, starts[radar])));
    const Outcome replayed = obliq({"replay", file, "--radar", radar, "--speed", "max"});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_GE(std::ranges::count(replayed.out, '\n'), 5) << replayed.out;  // four frames and the last line
  }
  // One clock: both begin with the recording, a frame's time apart at most but for a busy machine.
  EXPECT_LT(std::abs(starts["main"].utc_ns - starts["nose"].utc_ns), 2'000'000'000);
  outcome = obliq(all, {folder / "other.obliq", "--azimuths", "36:"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "other.obliq")) << "refused: nothing is left behind";
  EXPECT_EQ(obliq(all, {folder / "other.obliq", "--radar", "main"}).code, 1);
  const Daemon narrow({"--config", scene, "--set", "server.max_subscriptions=1"}, folder.path());
  outcome = obliq({"record", "--server", narrow.address(), "--all", "--out", folder / "other.obliq"});
  EXPECT_NE(outcome.err.find("--all: found 2 radars; allowed: 1"), std::string::npos) << outcome.err;
}

/// Sees frames, and knows how many.
struct Counter : client::FrameHandler {
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
    ++frames;
    return {};
  }
  int frames = 0;
};

TEST_F(RecordEvents, AllRadarsOfARecordingAreServedInStepWhoeverSteersWhich) {
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(obliq({"record", "--server", daemon.address(), "--all", "--rate", "20", "--seconds", "3",
                     "--out", file})
                  .code,
              0);
  }
  Running replay({"replay", file, "--serve", "--all", "--hold", "--port", "0"}, folder / "replay.log");
  (void)replay.await("replays radar nose");
  const std::string log = replay.log();
  std::map<std::string, client::Client> stations;
  std::map<std::string, Counter> counters;
  for (const std::string radar : {"main", "nose"}) {
    const std::size_t on = log.find(" on ", log.find("replays radar " + radar)) + 4;
    stations[radar] = connected(log.substr(on, log.find('\n', on) - on), radar);
    stations[radar].set_handler(&counters[radar]);
    (void)bookmarks_of(stations[radar]);  // ReplayState has come
  }
  client::Client& main = stations["main"];
  client::Client& nose = stations["nose"];
  EXPECT_EQ(main.replay_state()->start_utc_ns(), nose.replay_state()->start_utc_ns());
  wire::SetReplay request;
  request.set_paused(true);
  ASSERT_TRUE(is_ok(main.set_replay(request)));
  for (auto& [radar, station] : stations) ASSERT_TRUE(is_ok(station.subscribe(radar, 100)));
  for (const double at_s : {2.0, 0.75}) {
    request.set_seek_s(at_s);
    counters["nose"].frames = 0;
    ASSERT_TRUE(is_ok((at_s > 1 ? main : nose).set_replay(request)));
    for (auto& [radar, station] : stations) {
      while (std::abs(station.replay_state()->position_s() - at_s) > 1e-6 ||
             !station.replay_state()->paused())
        ASSERT_TRUE(is_ok(station.receive(kLong))) << radar;
    }
    while (counters["nose"].frames == 0)
      ASSERT_TRUE(is_ok(nose.receive(kLong)));  // of the place, in the pause
  }
  request.Clear();
  request.set_paused(false);
  request.set_speed(4);
  ASSERT_TRUE(is_ok(nose.set_replay(request)));
  while (!main.replay_state()->ended()) ASSERT_TRUE(is_ok(main.receive(kLong)));
  while (!nose.replay_state()->ended()) ASSERT_TRUE(is_ok(nose.receive(kLong)));
  EXPECT_EQ(main.replay_state()->speed(), 4);
  EXPECT_EQ(obliq({"replay", file, "--serve", "--all", "--loop"}).code, 1);
}

TEST_F(RecordEvents, TheCommandMarksAndLists) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::vector<std::string> server{"--server", daemon.address()};
  EXPECT_EQ(obliq({"bookmark", "first contact"}, server).code, 0);
  const Outcome listed = obliq({"bookmark", "--list"}, server);
  EXPECT_NE(listed.out.find("bookmark: first contact"), std::string::npos) << listed.out;
  ASSERT_EQ(obliq({"set", "receiver.gain_db=3"}, {"--server", daemon.address(), "--radar", "main"}).code, 0);
  EXPECT_EQ(obliq({"bookmark", "--list"}, server).out.find("gain"), std::string::npos);
  EXPECT_NE(obliq({"bookmark", "--events"}, server).out.find("sets receiver.gain_db = 3.0"),
            std::string::npos);
  const auto refused = [&](const std::vector<std::string>& words, const std::string& part) {
    const Outcome outcome = obliq(words, server);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  refused({"bookmark", std::string(100'000, 'x')}, "TEXT: found 100000 bytes; allowed: 1 to 1000 bytes");
  refused({"bookmark", "two\nlines"}, "TEXT: found a control character at byte 3");
  refused({"bookmark"}, "found no text; allowed: a text, --list, --events or --go NUMBER");
  refused({"bookmark", "--go", "1"}, "this server's radars are live");
}

TEST_F(RecordEvents, AViewerListsAndMayNotMark) {
  const std::string tokens =
      folder.write("tokens", "viewer viewer-0123456789\ncontroller controller-0123456789\n");
  ASSERT_EQ(chmod(tokens.c_str(), 0600), 0);
  for (const bool live : {true, false}) {
    SCOPED_TRACE(live);
    std::unique_ptr<Daemon> daemon;
    std::unique_ptr<Running> replay;
    std::string address;
    if (live) {
      daemon = std::make_unique<Daemon>(
          std::vector<std::string>{"--config", scene, "--set", "server.tokens=" + tokens}, folder.path());
      address = daemon->address();
    } else {
      replay = std::make_unique<Running>(
          std::vector<std::string>{"replay", made_log(), "--serve", "--hold", "--port", "0", "--set",
                                   "server.tokens=" + tokens},
          folder / "replay.log");
      address = replay->await(" on ");
    }
    client::Client viewer, controller;
    const auto come = [&](client::Client& to, const std::string& role) {
      ASSERT_TRUE(
          is_ok(to.connect(*client::parse_endpoint(address), {.name = role, .token = role + "-0123456789"})));
    };
    come(viewer, "viewer");
    come(controller, "controller");
    const std::size_t before = bookmarks_of(viewer).size();
    EXPECT_EQ(viewer.add_bookmark("mine").number, 108u);
    EXPECT_EQ(bookmarks_of(viewer).size(), before);
    EXPECT_TRUE(is_ok(controller.add_bookmark("by any controller, who claims nothing")));
    EXPECT_EQ(bookmarks_of(viewer).size(), before + 1);
  }
}

}  // namespace
}  // namespace obliq::test::record_events_test
