// Writes the seed corpora: fuzz_make_seeds tests/fuzz/corpus. They are kept in the tree, so this runs only
// when a format changes or a seed is added.
#include "tests/fuzz/make_seeds.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "proto/obliq.pb.h"
#include "tests/support/made_recording.h"

namespace obliq::fuzz {
namespace {

std::filesystem::path g_corpus;  // NOLINT: one program, one run

}  // namespace

const std::filesystem::path& corpus_folder() { return g_corpus; }

void write_seed(const std::string& target, const std::string& name, const std::string& bytes) {
  const auto folder = g_corpus / target;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
  std::printf("%s/%s: %zu bytes\n", target.c_str(), name.c_str(), bytes.size());
}

namespace {

// ---- A measured antenna ----

void write_patterns() {
  std::string both = "cut,angle_deg,gain_db\n";
  for (int k = -6; k <= 6; ++k) {
    const std::string row = std::to_string(k * 5) + "," + std::to_string(-k * k * 1.5) + "\n";
    both += "azimuth," + row + "elevation," + row;
  }
  write_seed("pattern", "both", both);
  write_seed("pattern", "azimuth_alone",
             "cut,angle_deg,gain_db\r\nazimuth,-2,-20\r\nazimuth,0,0\r\nazimuth,2,-20\r\n");
}

// ---- The stream ----

void write_streams() {
  const test::MadeRecording made = test::made_recording();
  write_seed("recording", "whole", kMended + made.bytes);
  write_seed("recording", "as_it_is", std::string(1, '\0') + made.bytes);
  test::MadeRecording two;
  std::uint64_t sequence = 0;
  test::add_frame(two, 1, sequence);
  std::uint64_t other = 0;
  test::add_frame(two, 1, other, true, "nose", 2);
  write_seed("recording", "two_radars", kMended + two.bytes);
  // Each message of a frame, and a frame.
  for (const test::MadeMessage& message : made.messages) {
    if (message.frame_id > 1) continue;
    write_seed("framing", "message_" + std::to_string(message.begin),
               kMended + made.bytes.substr(message.begin, message.end - message.begin));
  }
  write_seed("framing", "frames", kMended + two.bytes);
  // Integers, compressed, of a window.
  stream::StreamChoice choice;
  choice.format = {wire::IqEncoding::ci16_le, wire::Compression::zstd, 8, {{2, 6, 2}, {1, 0, 1}}};
  test::MadeRecording coded;
  std::uint64_t sequence_of_coded = 0;
  test::add_frame(coded, 1, sequence_of_coded, true, "main", 1, {choice});
  choice.format.window = {};
  test::add_frame(coded, 2, sequence_of_coded, true, "main", 1, {choice});
  write_seed("framing", "coded", kMended + coded.bytes);
  write_seed("recording", "coded", kMended + coded.bytes);
  write_trains();
}

// ---- Requests ----

template <typename Message>
Message named(const char* radar) {
  Message message;
  message.set_request_id(7);
  message.set_radar(radar);
  return message;
}

void write_requests() {
  using wire::MessageType;
  auto set = named<wire::SetSettings>("main");
  set.mutable_settings()->set_frequency_ghz(9.5);
  set.mutable_settings()->set_r_max_m(20000);
  set.mutable_settings()->set_speckle(wire::GEOMETRIC_SPECKLE);
  set.mutable_settings()->set_frustum(wire::SWEEP);
  set.mutable_settings()->set_azimuth_bins(64);
  set.mutable_settings()->set_range_bins(64);
  auto pose = named<wire::SetPose>("main");
  pose.mutable_pose()->set_latitude_deg(33);
  pose.mutable_pose()->set_longitude_deg(-99);
  pose.mutable_pose()->set_height_m(1200);
  pose.mutable_pose()->set_bearing_deg(270);
  pose.mutable_pose()->set_sim_time_ns(1);
  pose.mutable_pose()->set_pose_id(2);
  auto subscribe = named<wire::Subscribe>("nose");
  subscribe.set_rate_hz(10);
  subscribe.add_planes(wire::POWER);
  auto part = named<wire::Subscribe>("main");
  part.set_rate_hz(25);
  part.set_iq_encoding(wire::CI16_LE);
  part.set_compression(wire::ZSTD);
  part.set_lossless(true);
  part.mutable_window()->set_first_azimuth(8);
  part.mutable_window()->set_n_azimuth(100);
  part.mutable_window()->set_azimuth_step(4);
  part.mutable_window()->set_range_step(2);
  auto once = named<wire::RenderOnce>("main");
  *once.mutable_pose() = pose.pose();
  *once.mutable_settings() = set.settings();
  auto off = named<wire::SetState>("main");
  off.set_transmit(false);
  off.set_freeze(true);
  auto thaw = named<wire::SetState>("main");
  thaw.set_freeze(false);
  wire::QueryGround places;
  places.set_request_id(9);
  places.set_radar("main");
  for (int k = 0; k < 5; ++k) {
    places.add_latitude_deg(33 + 0.01 * k);
    places.add_longitude_deg(-99.5);
  }
  places.add_height_m(20);
  places.set_height_reference(wire::GROUND);
  wire::QueryGround ranges;
  *ranges.mutable_antenna() = pose.pose();
  ranges.add_bearing_deg(270);
  ranges.add_range_m(5000);
  wire::ListRadars list;
  wire::GetStatus status;
  const std::string claim = request(MessageType::claim_control, named<wire::ClaimControl>("main"));
  const std::string release = request(MessageType::release_control, named<wire::ReleaseControl>("main"));
  write_seed(
      "requests", "control",
      claim + request(MessageType::set_settings, set) + request(MessageType::set_pose, pose) + release);
  write_seed("requests", "switches",
             request(MessageType::set_state, thaw) + claim + request(MessageType::set_state, off) +
                 request(MessageType::set_pose, pose) + request(MessageType::set_state, off, true) +
                 request(MessageType::set_state, thaw) + release);
  write_seed("requests", "two_clients",
             claim + request(MessageType::claim_control, named<wire::ClaimControl>("main"), true) +
                 request(MessageType::set_pose, pose, true) + release);
  wire::ClaimControl of_settings = named<wire::ClaimControl>("main");
  of_settings.add_kinds(wire::SETTINGS_CLAIM);
  wire::SetPose aim = named<wire::SetPose>("main");
  aim.mutable_pose()->set_tilt_deg(-3);
  wire::SetPose timed = pose;
  timed.mutable_pose()->set_heading_deg(40);
  timed.mutable_pose()->set_new_time_line(true);
  timed.mutable_pose()->set_time_rate(10);
  write_seed("requests", "one_flies_one_operates",
             request(MessageType::claim_control, of_settings, true) + claim +
                 request(MessageType::set_pose, aim, true) + request(MessageType::set_pose, timed) + release);
  write_target_requests(once);
  wire::LoadExercise load;
  load.set_request_id(9);
  load.mutable_state()->set_version(1);
  for (const char* radar : {"main", "nose"}) {
    wire::RadarState& its = *load.mutable_state()->add_radars();
    its.set_radar(radar);
    *its.mutable_settings() = set.settings();
    *its.mutable_pose() = pose.pose();
    its.set_rate_limit_hz(5);
  }
  wire::SetExercise stop;
  stop.set_frozen(true);
  wire::GetExercise state;
  write_seed("requests", "exercise",
             request(MessageType::get_exercise, state) + request(MessageType::set_exercise, stop) +
                 request(MessageType::load_exercise, load) +
                 request(MessageType::reset_exercise, named<wire::ResetExercise>("nose")));
  write_seed("requests", "watch",
             request(MessageType::subscribe, subscribe) + request(MessageType::subscribe, subscribe, true) +
                 request(MessageType::unsubscribe, named<wire::Unsubscribe>("nose")));
  write_seed("requests", "watch_a_part", request(MessageType::subscribe, part));
  write_seed("requests", "render", request(MessageType::render_once, once));
  write_seed("requests", "query",
             request(MessageType::query_ground, places) + request(MessageType::query_ground, ranges, true));
  wire::SetReplay replay;
  replay.set_request_id(8);
  replay.set_paused(true);
  replay.set_speed(2);
  replay.set_seek_s(60);
  write_seed("requests", "replay", request(MessageType::set_replay, replay));
  write_seed("requests", "ask",
             request(MessageType::list_radars, list) +
                 request(MessageType::get_radar, named<wire::GetRadar>("nose")) +
                 request(MessageType::get_status, status));
}

// ---- Connections ----

/// Of fuzz_transport: its kinds are in its first lines.
std::string piece(int kind, const std::string& bytes) { return static_cast<char>(kind) + bytes + "\xfe\xfe"; }

std::string message_piece(wire::MessageType type, const std::string& descriptor, int kind = 0) {
  return piece(kind, static_cast<char>(type) + descriptor);
}

void write_connections() {
  using wire::MessageType;
  constexpr char kTcp = 0, kWeb = 1, kWebOpened = 3;
  constexpr int kBytes = 2, kWhole = 4, kPing = 3 | 8 | 9 << 4, kClose = 3 | 8 | 8 << 4, kPart = 3 | 2 << 4,
                kRest = 3 | 8;
  wire::Hello hello;
  hello.set_major(1);
  hello.set_client_name("fuzz");
  const std::string greeting = message_piece(MessageType::hello, hello.SerializeAsString());
  const auto ask = named<wire::GetRadar>("main").SerializeAsString();
  write_seed("transport", "tcp",
             kTcp + greeting + message_piece(MessageType::get_radar, ask, kWhole) +
                 message_piece(MessageType::list_radars, ""));
  write_seed("transport", "tcp_nonsense", kTcp + greeting + piece(kBytes, "GET / HTTP/1.1\r\n\r\n"));
  const std::string web = message_piece(MessageType::hello, R"({"major":1,"client_name":"fuzz"})");
  const std::string watch =
      message_piece(MessageType::subscribe, R"({"radar":"main","rate_hz":30,"planes":["VIDEO"]})");
  write_seed("transport", "web", kWeb + web + watch);
  // As protobuf a little less than the target lets in.
  write_seed(
      "transport", "web_name",
      kWeb + message_piece(MessageType::hello,
                           R"({"major":1,"client_name":")"
                           "a screen on the bridge of a ship that is underway in coastal waters, third desk"
                           R"("})"));
  write_seed("transport", "web_query",
             kWeb + web +
                 message_piece(MessageType::query_ground,
                               R"({"latitude_deg":[1,2,3,4,5],"longitude_deg":[1,2,3,4,5]})"));
  write_seed("transport", "web_frames",
             kWeb + web + piece(kPing, "there?") + piece(kPart, "OB") + piece(kRest, "LQ") +
                 piece(kClose, "\3\350"));
  const std::string opening =
      "GET /stream HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n";
  write_seed("transport", "web_opening", kWebOpened + opening + "\xfe\xfe" + web);
}

// ---- Modbus ----

/// Function and data, for unit 1 in a header that is made right.
std::string modbus(const std::vector<int>& bytes) {
  std::string frame{'\1', static_cast<char>(bytes.size())};
  for (const int byte : bytes) frame += static_cast<char>(byte);
  return frame;
}

/// Big-endian, as DIS is; obliq's own datagram is little-endian.
template <typename Number>
std::string number_bytes(Number value, bool big) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) std::ranges::reverse(bytes);
  return bytes;
}

void write_ownship() {
  std::string pose = "OBLP" + number_bytes(std::uint16_t{1}, false) + number_bytes(std::uint16_t{0}, false) +
                     number_bytes(std::int64_t{1'000'000'000}, false);
  for (const double value : {33.0, -99.5, 1500.0, 60.0}) pose += number_bytes(value, false);
  write_seed("ownship", "pose", pose + number_bytes(std::uint64_t{7}, false));
  std::string motion = pose + number_bytes(std::uint64_t{7}, false);
  motion[4] = 2;
  motion[6] = 3;
  for (const double value : {200.0, -10.0, 1.5, 20.0, -5.0}) motion += number_bytes(value, false);
  write_seed("ownship", "motion", motion);
  // Entity State, IEEE 1278.1-2012, 7.2.2: entity 1:2:3 near 33 N 99.5 W, flying at 200 m/s.
  std::string pdu{7, 1, 1, 1, 0, 0, 0, 0, 0, static_cast<char>(144), 0, 0, 0, 1, 0, 2, 0, 3};
  pdu.resize(36, '\0');
  for (const float value : {200.0F, 0.0F, 0.0F}) pdu += number_bytes(value, true);
  for (const double value : {-884000.0, -5281500.0, 3454500.0}) pdu += number_bytes(value, true);
  for (const float value : {1.0F, -0.5F, 0.0F}) pdu += number_bytes(value, true);
  pdu.resize(88, '\0');
  pdu += '\4';
  pdu.resize(144, '\0');
  write_seed("ownship", "entity", pdu);
  // Stop/Freeze to 1:2:3, 7.5.5.
  std::string stop{7, 1, 14, 5, 0, 0, 0, 0, 0, 40, 0, 0, 0, 9, 0, 9, 0, 9, 0, 1, 0, 2, 0, 3};
  stop.resize(40, '\0');
  write_seed("ownship", "stop", stop);
}

void write_modbus() {
  const std::string pose = modbus({16, 0, 204, 0, 2, 4, 0, 0x12, 0x4F, 0x80}) +    // height 1200 m
                           modbus({16, 0, 210, 0, 2, 4, 0x05, 0x5D, 0x4A, 0x80});  // bearing 90 degrees
  const std::string apply = modbus({5, 0, 2, 0xFF, 0});
  write_seed("modbus", "read",
             modbus({3, 0, 0, 0, 10}) + modbus({4, 0, 200, 0, 60}) + modbus({1, 0, 0, 0, 5}) +
                 modbus({2, 0, 0, 0, 6}));
  write_seed("modbus", "pose", pose + apply);
  write_seed("modbus", "refused", modbus({6, 0, 254, 0xFF, 0xFF}) + modbus({6, 0, 250, 0, 9}) + apply);
  write_seed("modbus", "coils",
             modbus({5, 0, 0, 0, 0}) + modbus({15, 0, 0, 0, 7, 1, 0x7B}) + pose + modbus({5, 0, 4, 0xFF, 0}));
  write_seed("modbus", "others",
             modbus({22, 0, 230, 0, 0, 0, 5}) + modbus({23, 0, 200, 0, 4, 0, 230, 0, 1, 2, 0, 100}) +
                 modbus({6, 1, 44, 0, 7}));
}

// ---- Scene files ----

constexpr const char* kScene = R"([terrain]
synthetic = "ridge"
shape = { distance_m = 5000.0, height_m = 200 }
cell_m = 64.0
area = [[-99.6, 32.9], [-99.4, 32.9], [-99.4, 33.1]]
[earth]
radius_factor = inf
[[buildings]]
source = "houses.gpkg"
height_field = "height"
default_height_m = 8.0
[[prisms]]
per_km2 = 0.5
seed = 7
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1500.0
height_reference = "ground"
bearing_deg = 20.0
[frustum]
kind = "oblique"
pixels = [64, 32]
[bins]
azimuth = 36
range = 32
[materials.terrain]
model = "constant_gamma"
gamma_db = -3
[materials.water]
model = "geometric_optics"
reflectivity = 0.5
rms_slope = 0.1
[server]
port = 0
[run]
threads = 1
[[radar]]
name = "main"
sector_deg = 60.0
r_min_m = 2000.0
r_max_m = 9000.0
[[radar]]
name = "nose"
antenna.bearing_deg = 90.0
)";

void write_configurations() {
  write_seed("configuration", "much", kScene);
  write_seed("configuration", "least", "[terrain]\nsynthetic = \"flat\"\n");
  write_seed("configuration", "wrong",
             "[terrain]\nsynthetic = \"flatt\"\n[radar]\nr_max_m = 1e400\nr_min = nan\n");
  write_seed("configuration", "quality",
             "terrain.synthetic = 'hills'\nfrustum.quality = 'draft'\n[accuracy]\nmedian_db = 0.1\n");
  write_seed("configuration", "sea",
             "terrain.synthetic = 'flat'\nradar.mode = 'mti'\nbeam.pattern = 'gaussian'\nsea.state = 'auto'\n"
             "sea.shape = 0.3\natmosphere.wind_m_s = 8\n[materials.terrain]\nmodel = 'sea'\n[[surfaces]]\n"
             "source = 'fields.geojson'\nmaterial = 'water'\n[[surfaces]]\ngamma_raster = 'gamma.tif'\n"
             "gamma_raster_is = 'offset'\n");
}

}  // namespace
}  // namespace obliq::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  obliq::fuzz::g_corpus = argv[1];
  std::filesystem::create_directories(obliq::fuzz::g_corpus);
  obliq::fuzz::write_streams();
  obliq::fuzz::write_patterns();
  obliq::fuzz::write_requests();
  obliq::fuzz::write_connections();
  obliq::fuzz::write_modbus();
  obliq::fuzz::write_ownship();
  obliq::fuzz::write_elevations();
  obliq::fuzz::write_footprints();
  obliq::fuzz::write_configurations();
  return 0;
}
