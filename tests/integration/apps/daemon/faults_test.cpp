// Faults of the machine under a running obliqd: elevation files that change, no memory, no descriptors, a
// process that stands still. Watchers lose nothing.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <functional>
#include <future>
#include <thread>

#include "client/frame_assembler.h"
#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"
#include "tests/support/process_memory.h"
#include "tests/unit/terrain_files.h"

namespace obliq::test::faults_test {
namespace {

using client::FrameAssembler;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

std::string scene_text(const std::string& terrain, const std::string& more = "") {
  return text_of(SmallScene{.terrain = terrain,
                            .antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\n",
                            .pixels = 256,
                            .azimuth_bins = 180,
                            .range_bins = 128,
                            .server = more});
}

/// Watches a radar.
class Watcher {
 public:
  Watcher(const Daemon& daemon, double rate_hz) : daemon_(daemon) {
    const client::Status status = client.connect(*client::parse_endpoint(daemon.address()));
    EXPECT_TRUE(status.ok()) << status.sentence() << "\n" << daemon.log();
    client.set_handler(&frames);
    EXPECT_TRUE(client.subscribe("main", rate_hz).ok());
  }
  /// Empty, with a failure, when the client is dropped.
  std::vector<double> next_frame() {
    while (frames.state() != FrameAssembler::State::complete) {
      const client::Status status = client.receive(kLong);
      if (frames.state() == FrameAssembler::State::aborted) (void)frames.take();
      if (status.outcome == client::Outcome::refused && status.number >= 100) {
        refusals.push_back(status);
        continue;
      }
      if (!status.ok()) {
        ADD_FAILURE() << status.sentence() << "\n" << daemon_.log();
        return {};
      }
    }
    return frames.take().power_w;
  }

  client::Client client;
  FrameAssembler frames;
  std::vector<client::Status> refusals;  ///< Errors that concern the radar

 private:
  const Daemon& daemon_;
};

using Faults = ProgramTest;

// ---- Elevation files that change ----

/// About 20 km around the antenna in pixels of half a second: 16 MB without compression.
std::string write_elevation(const Folder& files, const std::string& name, double height_m) {
  RasterPlan plan =
      around(-99.5, 33, [height_m](double x, double) { return height_m + 100 * std::sin(500 * x); });
  constexpr int kSide = 2000;
  constexpr double kPixel_deg = 1.0 / 7200;
  plan.columns = plan.rows = kSide;
  plan.geotransform = {-99.5 - kSide * kPixel_deg / 2, kPixel_deg, 0,
                       33 + kSide * kPixel_deg / 2,    0,          -kPixel_deg};
  return write_raster(files, name, plan);
}

bool holds_open(pid_t pid, const std::string& path) {
  std::error_code ignored;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", ignored)) {
    if (std::filesystem::read_symlink(entry.path(), ignored) == path) return true;
  }
  return false;
}

// With the file mapped instead of read (GTIFF_VIRTUAL_MEM_IO heeded) the daemon dies of SIGBUS.
TEST_F(Faults, AnElevationFileThatIsCutShortWhileItIsReadIsAClearErrorNeverACrash) {
  const Folder files;
  setenv("GTIFF_VIRTUAL_MEM_IO", "YES", 1);  // a line of it in the environment must not endanger a service
  int refused = 0;
  for (int delay_ms = 0; delay_ms < 40; delay_ms += 8) {
    const std::string dem = write_elevation(files, "dem.tif", 300);
    const std::string scene = folder.write("scene.toml", scene_text("dem = \"" + dem + "\"\n"));
    Daemon daemon({"--config", scene}, folder.path(), "loading terrain");
    while (!holds_open(daemon.pid(), dem) && daemon.log().find("terrain: ") == std::string::npos) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    std::filesystem::resize_file(dem, 4096);
    const auto settled = [&] {
      siginfo_t info{};
      return daemon.log().find("ready: ") != std::string::npos ||
             (waitid(P_PID, static_cast<id_t>(daemon.pid()), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
              info.si_pid != 0);
    };
    while (!settled()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const bool ready = daemon.log().find("ready: ") != std::string::npos;
    if (ready) daemon.send_signal(SIGTERM);
    const int code = daemon.wait();
    if (ready) {
      EXPECT_EQ(code, 0) << daemon.log();
    } else {
      ++refused;
      EXPECT_EQ(code, 1) << daemon.log();
      EXPECT_NE(daemon.log().find(dem), std::string::npos) << daemon.log();
    }
  }
  unsetenv("GTIFF_VIRTUAL_MEM_IO");
  EXPECT_GT(refused, 0) << "the file was never cut while it was being read: the test needs a larger one";
}

TEST_F(Faults, OnceLoadedAnElevationFileMayBeCutOverwrittenOrRemoved) {
  const Folder files;
  const std::string dem = write_elevation(files, "dem.tif", 300);
  const std::string scene = folder.write("scene.toml", scene_text("dem = \"" + dem + "\"\n"));
  const Daemon daemon({"--config", scene}, folder.path());
  Watcher watcher(daemon, 50);
  const auto before = watcher.next_frame();
  ASSERT_FALSE(before.empty());
  const auto unchanged = [&](const char* what) {
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(watcher.next_frame() == before) << what;
    const Outcome got = obliq({"get", "--server", daemon.address(), "--out", folder / "got"});
    EXPECT_EQ(got.code, 0) << what << ": " << got.err;
  };
  EXPECT_FALSE(holds_open(daemon.pid(), dem));
  EXPECT_EQ(text_of("/proc/" + std::to_string(daemon.pid()) + "/maps").find(dem), std::string::npos);
  std::filesystem::resize_file(dem, 4096);
  unchanged("cut");
  std::ofstream(dem, std::ios::binary) << std::string(1 << 20, 'x');
  unchanged("overwritten");
  // What it says when it is to be loaded anew: the old scene goes on.
  daemon.send_signal(SIGHUP);
  folder.write("scene.toml", scene_text("dem = \"" + dem + "\"\ndefault_material = \"water\"\n"));
  while (daemon.log().find("send SIGHUP again") == std::string::npos &&
         daemon.log().find("reload refused") == std::string::npos &&
         daemon.log().find("the scene is the same") == std::string::npos) {
    ASSERT_FALSE(watcher.next_frame().empty());
  }
  unchanged("reload refused");
  std::filesystem::remove(dem);
  unchanged("removed");
}

// ---- No memory ----

void allow_more_memory(pid_t pid, std::uint64_t bytes) {
  const rlim_t most = memory_of(pid).address_space_bytes + bytes;
  const rlimit limit{most, RLIM_INFINITY};
  ASSERT_EQ(prlimit(pid, RLIMIT_AS, &limit, nullptr), 0);
}

/// Few azimuth bins: each then has millions of scatterers. The pixels alone take bounded memory, and long.
void make_huge(wire::RadarSettings& settings) {
  settings.set_azimuth_bins(8);
  settings.set_range_bins(8192);
  settings.set_pixel_columns(16384);
  settings.set_pixel_rows(16384);
}

/// Takes what comes without keeping it.
class Discard : public client::FrameHandler {
 public:
  client::Status on_abort(const wire::MessageHeader&, const wire::FrameAbort& abort) override {
    return client::Status::failure(client::Outcome::aborted, abort.reason());
  }
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
    return client::Status::failure(client::Outcome::aborted, "the frame was rendered");
  }
};

std::string refusal_of_huge_frame(const Daemon& daemon) {
  client::Client guest;
  Discard discard;
  guest.set_handler(&discard);
  client::Status status = guest.connect(*client::parse_endpoint(daemon.address()));
  wire::RadarInfo info;
  if (status.ok()) status = guest.get_radar("main", info);
  wire::RenderOnce request;
  request.set_radar("main");
  *request.mutable_settings() = info.settings();
  *request.mutable_pose() = info.pose();
  make_huge(*request.mutable_settings());
  if (status.ok()) status = guest.render_once(request);
  while (status.ok()) status = guest.receive(kLong);
  return status.sentence();
}

TEST_F(Faults, AFrameForWhichThereIsNoMemoryIsRefusedAndOthersAreServedOn) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer ends the process when there is no memory";
  const Daemon daemon({"--config", folder.write("scene.toml", scene_text(kRidge))}, folder.path());
  Watcher watcher(daemon, 50);
  const auto before = watcher.next_frame();
  for (const std::uint64_t more : {64u << 20, 4u << 20, 1u << 20, 0u}) {
    allow_more_memory(daemon.pid(), more);
    EXPECT_NE(refusal_of_huge_frame(daemon).find("memory"), std::string::npos) << more;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(watcher.next_frame() == before) << more;
  }
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  ASSERT_EQ(prlimit(daemon.pid(), RLIMIT_AS, &none, nullptr), 0);
  EXPECT_EQ(obliq({"get", "--server", daemon.address(), "--out", folder / "got"}).code, 0);
}

TEST_F(Faults, SettingsForWhichThereIsNoMemoryAreAFaultUntilSmallerOnesCome) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer ends the process when there is no memory";
  const Daemon daemon({"--config", folder.write("scene.toml", scene_text(kRidge))}, folder.path());
  Watcher watcher(daemon, 50);
  const auto before = watcher.next_frame();
  client::Client controller = connected(daemon.address());
  ASSERT_TRUE(controller.claim_control("main").ok());
  wire::RadarInfo info;
  ASSERT_TRUE(controller.get_radar("main", info).ok());
  wire::RadarSettings huge = info.settings();
  make_huge(huge);
  allow_more_memory(daemon.pid(), 16 << 20);
  wire::Ack ack;
  const client::Status set = controller.set_settings("main", huge, ack);
  if (set.ok()) {  // else it was refused at once, which is as well
    while (watcher.refusals.empty()) {
      const client::Status status = watcher.client.receive(kLong);
      if (watcher.frames.state() != FrameAssembler::State::receiving) (void)watcher.frames.take();
      if (status.outcome == client::Outcome::refused) {
        watcher.refusals.push_back(status);
      } else {
        ASSERT_TRUE(status.ok()) << status.sentence();
      }
    }
    EXPECT_NE(watcher.refusals[0].sentence().find("memory"), std::string::npos)
        << watcher.refusals[0].sentence();
    ASSERT_TRUE(controller.set_settings("main", info.settings(), ack).ok());
  }
  EXPECT_TRUE(watcher.next_frame() == before);
}

// ---- No descriptors ----

std::size_t open_descriptors(pid_t pid) {
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd")) {
    ++n;
  }
  return n;
}

TEST_F(Faults, WithoutDescriptorsNewcomersWaitAndOthersAreServedOn) {
  if (kSanitized)
    GTEST_SKIP() << "a sanitizer looks at memory through a pipe, for which there is no descriptor";
  const Daemon daemon({"--config", folder.write("scene.toml", scene_text(kRidge))}, folder.path());
  Watcher watcher(daemon, 50);
  const auto before = watcher.next_frame();
  constexpr std::size_t kSpare = 2;
  const rlimit few{open_descriptors(daemon.pid()) + kSpare, 4096};
  ASSERT_EQ(prlimit(daemon.pid(), RLIMIT_NOFILE, &few, nullptr), 0);
  std::vector<client::Client> guests(kSpare);
  for (client::Client& guest : guests) {
    ASSERT_TRUE(guest.connect(*client::parse_endpoint(daemon.address())).ok()) << daemon.log();
  }
  auto waiting = std::async(std::launch::async, [&] {
    client::Client newcomer;
    return newcomer.connect(*client::parse_endpoint(daemon.address()));
  });
  while (daemon.log().find("LimitNOFILE") == std::string::npos) {
    ASSERT_TRUE(watcher.next_frame() == before);
  }
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(watcher.next_frame() == before);
  guests.clear();
  EXPECT_TRUE(waiting.get().ok()) << "there are descriptors again";
  const std::string log = daemon.log();
  const std::size_t said = log.find("LimitNOFILE");
  EXPECT_EQ(log.find("LimitNOFILE", said + 1), std::string::npos) << "one line, not five a second:\n" << log;
}

// ---- A wall clock that jumps ----

// Fails when any deadline or frame's date is taken from the wall clock: a day forward ends patience with
// every client, a day back makes the next frame wait for a day.
TEST_F(Faults, AWallClockThatJumpsByADayNeitherStallsFramesNorDropsClients) {
  // Debian's package libfaketime (https://github.com/wolfcw/libfaketime); the monotonic clock is left alone,
  // as setting a machine's clock leaves it alone.
  const std::string library = LIBRARY_FOLDER "/faketime/libfaketimeMT.so.1";
  if (kSanitized) GTEST_SKIP() << "a sanitizer's runtime must be the first library, libfaketime too";
  if (!std::filesystem::exists(library)) GTEST_SKIP() << library << " is not installed (package libfaketime)";
  const std::string offset = folder.write("offset", "+0\n");
  const std::vector<std::pair<const char*, std::string>> environment = {
      {"LD_PRELOAD", library},
      {"FAKETIME_TIMESTAMP_FILE", offset},
      {"FAKETIME_NO_CACHE", "1"},
      {"FAKETIME_DONT_FAKE_MONOTONIC", "1"}};
  const std::string patience = "idle_timeout_s = 20.0\nheartbeat_s = 1.0\nhandshake_timeout_s = 20.0\n";
  const std::string scene = folder.write("scene.toml", scene_text(kRidge, patience));
  for (const auto& [name, value] : environment) setenv(name, value.c_str(), 1);
  const Daemon daemon({"--config", scene}, folder.path());
  for (const auto& [name, value] : environment) unsetenv(name);
  Watcher watcher(daemon, 50);
  const auto before = watcher.next_frame();
  const std::string date = daemon.log().substr(0, daemon.log().find(' '));
  for (const char* jump : {"+1d", "-1d", "+0", "-30d"}) {
    folder.write("offset", std::string(jump) + "\n");
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(watcher.next_frame() == before) << jump;
    const Watcher newcomer(daemon, 1);
  }
  const std::string log = daemon.log();
  EXPECT_NE(log.substr(log.rfind("[obliqd]", log.size()) - 27, date.size()), date) << "the clock did jump:\n"
                                                                                   << log;
}

// ---- A process that stands still ----

// Fails when a deadline that ran out while the daemon stood still is held against a client.
TEST_F(Faults, ClientsArePunishedForTheirOwnSilenceNotForTheDaemons) {
  const std::string patience =
      "stall_timeout_s = 4.0\nmessage_timeout_s = 4.0\nidle_timeout_s = 4.0\nheartbeat_s = 0.5\n";
  // Long frames, but none as long as that.
  const std::string azimuths = kSanitized ? "bins.azimuth=128" : "bins.azimuth=1024";
  const Daemon daemon({"--config", folder.write("scene.toml", scene_text(kRidge, patience)), "--set",
                       azimuths, "--set", "bins.range=2048"},
                      folder.path());
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < 4; ++i) watchers.push_back(std::make_unique<Watcher>(daemon, 50));
  // All at once, or those that wait for their turn are silent.
  const auto each = [&](const std::function<bool(Watcher&)>& act) {
    std::vector<std::future<bool>> done;
    for (auto& watcher : watchers)
      done.push_back(std::async(std::launch::async, [&act, &watcher] { return act(*watcher); }));
    return std::ranges::count_if(done, [](auto& result) { return result.get(); });
  };
  const auto reads_a_frame = [](Watcher& watcher) { return !watcher.next_frame().empty(); };
  const auto is_within_a_frame = [](Watcher& watcher) {
    while (watcher.frames.state() != FrameAssembler::State::receiving) {
      if (!watcher.client.receive(kLong).ok()) return false;
      if (watcher.frames.state() == FrameAssembler::State::complete) (void)watcher.frames.take();
    }
    return true;
  };
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(each(is_within_a_frame), 4) << daemon.log();
    daemon.send_signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::seconds(6));  // longer than any patience above
    daemon.send_signal(SIGCONT);
    ASSERT_EQ(each(reads_a_frame), 4) << round;
  }
}

}  // namespace
}  // namespace obliq::test::faults_test
