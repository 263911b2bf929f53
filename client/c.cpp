#include "client/c.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "client/c_frames.h"
#include "client/client.h"
#include "client/frame_assembler.h"
#include "client/settings_text.h"
#include "proto/ground_record.h"
#include "proto/obliq.pb.h"
// After the messages:
#include "client/c_client.h"

using namespace obliq;
using namespace obliq::client::c;
using client::Outcome;
using client::Status;

static_assert(static_cast<int>(Outcome::untrusted) == OBLIQ_UNTRUSTED &&
              static_cast<int>(Outcome::refused) == OBLIQ_REFUSED);
static_assert(wire::plane_bit(wire::Plane::iq) == OBLIQ_IQ &&
              wire::plane_bit(wire::Plane::video) == OBLIQ_VIDEO &&
              wire::plane_bit(wire::Plane::returns) == OBLIQ_RETURNS &&
              wire::plane_bit(wire::Plane::target) == OBLIQ_TARGET);
static_assert(sizeof(std::complex<float>) == 2 * sizeof(float));

namespace {

/// Of obliq_planes.
constexpr unsigned kNoPlanes = OBLIQ_TRUTH | OBLIQ_LIVE_TARGETS;

void write(const obliq_pose& from, wire::Pose& to) {
  if (!std::isnan(from.latitude_deg)) to.set_latitude_deg(from.latitude_deg);
  if (!std::isnan(from.longitude_deg)) to.set_longitude_deg(from.longitude_deg);
  if (!std::isnan(from.height_m)) to.set_height_m(from.height_m);
  if (!std::isnan(from.bearing_deg)) to.set_bearing_deg(from.bearing_deg);
  if (!std::isnan(from.tilt_deg)) to.set_tilt_deg(from.tilt_deg);
  if (!std::isnan(from.valid_s)) to.set_valid_s(from.valid_s);
  if (from.sim_time_ns != kNoTime) to.set_sim_time_ns(from.sim_time_ns);
  if (from.pose_id != 0) to.set_pose_id(from.pose_id);
  if (!std::isnan(from.heading_deg)) to.set_heading_deg(from.heading_deg);
  if (!std::isnan(from.velocity_north_m_s)) to.set_velocity_north_m_s(from.velocity_north_m_s);
  if (!std::isnan(from.velocity_east_m_s)) to.set_velocity_east_m_s(from.velocity_east_m_s);
  if (!std::isnan(from.velocity_up_m_s)) to.set_velocity_up_m_s(from.velocity_up_m_s);
  if (!std::isnan(from.roll_deg)) to.set_roll_deg(from.roll_deg);
  if (!std::isnan(from.pitch_deg)) to.set_pitch_deg(from.pitch_deg);
}

obliq_pose read(const wire::Pose& from) {
  return {from.latitude_deg(),
          from.longitude_deg(),
          from.height_m(),
          from.bearing_deg(),
          from.tilt_deg(),
          from.valid_s(),
          from.has_sim_time_ns() ? from.sim_time_ns() : kNoTime,
          from.pose_id(),
          from.has_heading_deg() ? from.heading_deg() : from.bearing_deg(),  // of a server of version 1.1
          from.has_velocity_north_m_s() ? from.velocity_north_m_s() : kNone,
          from.has_velocity_east_m_s() ? from.velocity_east_m_s() : kNone,
          from.has_velocity_up_m_s() ? from.velocity_up_m_s() : kNone,
          from.roll_deg(),
          from.pitch_deg()};
}

/// planes: a sum of obliq_planes. allowed_beside: of those that are no planes.
template <class Request>
Status read_planes(unsigned planes, unsigned allowed_beside, Request& request) {
  const unsigned beside = planes & kNoPlanes;
  if ((planes & wire::kBinPlanes) == 0 || (planes & ~(wire::kBinPlanes | kNoPlanes)) != 0)
    return bad("planes: found " + std::to_string(planes) + "; allowed: a sum of obliq_planes");
  if ((beside & ~allowed_beside) != 0)
    return bad("planes: found OBLIQ_LIVE_TARGETS; allowed: of obliq_render() alone");
  for (int plane = 0; plane < wire::kPlanes; ++plane)
    if ((planes >> plane & 1u) != 0) request.add_planes(static_cast<wire::PlaneKind>(plane));
  request.set_truth((planes & OBLIQ_TRUTH) != 0);
  return {};
}

template <class Value>
const Value* plane_or_null(const std::vector<Value>& plane) {
  return plane.empty() ? nullptr : plane.data();
}

void show(obliq_client& self, obliq_frame& to) {
  const client::AssembledFrame& frame = self.shown;
  const wire::FrameDescriptor& d = *frame.descriptor;
  self.radar = d.radar();
  read_truth(self);
  to = {self.radar.c_str(),
        d.frame_id(),
        frame.request_id,
        frame.frames_skipped,
        frame.n_azimuth,
        frame.n_range,
        d.azimuth_start_deg(),
        d.azimuth_width_deg(),
        d.range_start_m(),
        d.range_spacing_m(),
        d.video_floor_db(),
        d.settings().video_span_db(),
        read(d.pose()),
        reinterpret_cast<const float*>(plane_or_null(frame.iq)),
        plane_or_null(frame.power_w),
        plane_or_null(frame.count),
        plane_or_null(frame.state),
        plane_or_null(frame.video),
        plane_or_null(frame.material),
        plane_or_null(frame.building),
        plane_or_null(frame.height_m),
        plane_or_null(frame.returns),
        plane_or_null(frame.target),
        plane_or_null(self.truth),
        self.truth.size()};
}

int seen(wire::Sight sight) {
  if (sight == wire::Sight::visible) return 1;
  const bool hidden = sight == wire::Sight::behind_ground || sight == wire::Sight::behind_building ||
                      sight == wire::Sight::below_ground || sight == wire::Sight::inside_building;
  return hidden ? 0 : -1;
}

}  // namespace

extern "C" {

obliq_client* obliq_open(void) {
  try {
    return new obliq_client;
  } catch (...) {
    return nullptr;
  }
}

void obliq_close(obliq_client* client) { delete client; }

int obliq_connect(obliq_client* client, const char* address, const char* name, const char* token) {
  return guarded(client, [&] {
    const auto endpoint = client::parse_endpoint(text_of(address));
    if (!endpoint) return bad("address: found \"" + text_of(address) + "\"; allowed: HOST:PORT");
    client::ClientOptions options;
    if (name != nullptr) options.name = name;
    options.token = text_of(token);
    client->client.set_handler(&client->frames);
    return client->client.connect(*endpoint, options);
  });
}

const char* obliq_error(const obliq_client* client) {
  return client != nullptr ? client->error.c_str() : "no client";
}
uint32_t obliq_error_number(const obliq_client* client) { return client != nullptr ? client->number : 0; }
const char* obliq_warnings(const obliq_client* client) {
  return client != nullptr ? client->warning_lines.c_str() : "";
}

const char* obliq_radar(const obliq_client* client, int index) {
  if (client == nullptr || !client->client.is_open()) return nullptr;
  const wire::Welcome& welcome = client->client.welcome();
  return index >= 0 && index < welcome.radars_size() ? welcome.radars(index).c_str() : nullptr;
}

int obliq_claim(obliq_client* client, const char* radar, int force) {
  return guarded(client, [&] { return client->client.claim_control(text_of(radar), force != 0); });
}
int obliq_claim_part(obliq_client* client, const char* radar, unsigned claims, int force) {
  static_assert(OBLIQ_POSE == wire::kPoseClaim && OBLIQ_SETTINGS == wire::kSettingsClaim);
  return guarded(client, [&] {
    if (claims == 0 || claims > wire::kEveryClaim)
      return bad("claims: found " + std::to_string(claims) +
                 "; allowed: OBLIQ_POSE, OBLIQ_SETTINGS, or their sum");
    return client->client.claim(text_of(radar), static_cast<wire::ClaimSet>(claims), force != 0);
  });
}
int obliq_release(obliq_client* client, const char* radar) {
  return guarded(client, [&] { return client->client.release_control(text_of(radar)); });
}

void obliq_no_pose(obliq_pose* pose) {
  if (pose == nullptr) return;
  *pose = {kNone, kNone, kNone, kNone, kNone, kNone, kNoTime, 0, kNone, kNone, kNone, kNone, kNone, kNone};
}

int obliq_move(obliq_client* client, const char* radar, const obliq_pose* pose) {
  return guarded(client, [&] {
    if (pose == nullptr) return bad("pose: found NULL; allowed: a pose");
    wire::Pose to;
    write(*pose, to);
    wire::Ack ack;
    Status status = client->client.set_pose(text_of(radar), to, ack);
    client->warnings.assign(ack.warnings().begin(), ack.warnings().end());
    return status;
  });
}

int obliq_where(obliq_client* client, const char* radar, obliq_pose* pose) {
  return guarded(client, [&] {
    if (pose == nullptr) return bad("pose: found NULL; allowed: a place for one");
    wire::RadarInfo info;
    Status status = client->client.get_radar(text_of(radar), info);
    if (status.ok()) *pose = read(info.pose());
    return status;
  });
}

int obliq_set(obliq_client* client, const char* radar, const char* settings) {
  return guarded(client, [&] {
    wire::RadarSettings wanted;
    if (Status status = client::read_settings(text_of(settings), wanted); !status.ok()) return status;
    wire::Ack ack;
    Status status = client->client.set_settings(text_of(radar), wanted, ack);
    client->warnings.assign(ack.warnings().begin(), ack.warnings().end());
    return status;
  });
}

int obliq_get(obliq_client* client, const char* radar, const char* setting, char* text, size_t size) {
  return guarded(client, [&] {
    wire::RadarInfo info;
    if (Status status = client->client.get_radar(text_of(radar), info); !status.ok()) return status;
    if (!info.has_settings()) return bad("radar: found " + text_of(radar) + ", a platform; allowed: a radar");
    if (text == nullptr) return bad("text: found NULL; allowed: a place for it");
    const auto found = client::setting_text(info.settings(), text_of(setting));
    if (!found)
      return bad(text_of(setting) + ": found no field of RadarSettings; allowed: those of obliq.proto");
    if (found->size() >= size)
      return bad("size: found " + std::to_string(size) + "; allowed: at least " +
                 std::to_string(found->size() + 1));
    std::memcpy(text, found->c_str(), found->size() + 1);
    return Status{};
  });
}

int obliq_subscribe(obliq_client* client, const char* radar, double rate_hz, unsigned planes) {
  return guarded(client, [&] {
    wire::Subscribe request;
    request.set_radar(text_of(radar));
    request.set_rate_hz(rate_hz);
    if (Status status = read_planes(planes, OBLIQ_TRUTH, request); !status.ok()) return status;
    // Frames that arrive before the answer are still of the subscription before.
    Status status = client->client.subscribe(request);
    if (status.ok())
      client->frames.watch(request.radar(), static_cast<wire::PlaneSet>(planes & wire::kBinPlanes));
    return status;
  });
}
int obliq_unsubscribe(obliq_client* client, const char* radar) {
  return guarded(client, [&] {
    client->frames.unwatch(text_of(radar));
    return client->client.unsubscribe(text_of(radar));
  });
}

int obliq_render(obliq_client* client, const char* radar, const obliq_pose* pose, const char* settings,
                 unsigned planes, uint64_t* request_id) {
  return guarded(client, [&] {
    wire::RenderOnce request;
    request.set_radar(text_of(radar));
    request.set_as_live(true);
    if (pose != nullptr) write(*pose, *request.mutable_pose());
    if (Status status = client::read_settings(text_of(settings), *request.mutable_settings()); !status.ok())
      return status;
    if (Status status = read_planes(planes, kNoPlanes, request); !status.ok()) return status;
    request.set_live_targets((planes & OBLIQ_LIVE_TARGETS) != 0);
    Status status = client->client.render_once(request);
    const auto wanted = static_cast<wire::PlaneSet>(planes & wire::kBinPlanes);
    if (status.ok()) client->frames.of_request[request.request_id()] = wanted;
    if (status.ok() && request_id != nullptr) *request_id = request.request_id();
    return status;
  });
}

int obliq_receive(obliq_client* client, obliq_frame* frame, int timeout_ms) {
  return guarded(client, [&] {
    if (frame == nullptr) return bad("frame: found NULL; allowed: a place for one");
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(std::max(0, timeout_ms));
    client::FramesOfStreams& frames = client->frames;
    while (frames.whole.empty()) {
      const auto left = std::chrono::duration_cast<client::Timeout>(end - std::chrono::steady_clock::now());
      if (Status status = client->client.receive(std::max(left, client::Timeout(0))); !status.ok())
        return status;
      if (!frames.aborted.empty())
        return Status::failure(Outcome::aborted, std::exchange(frames.aborted, ""));
    }
    client->shown = std::move(frames.whole.front());
    frames.whole.pop_front();
    show(*client, *frame);
    return Status{};
  });
}

int obliq_query(obliq_client* client, const char* radar, size_t n, const double* latitude_deg,
                const double* longitude_deg, const double* height_m, obliq_ground* ground) {
  return guarded(client, [&] {
    if (n > 0 && (latitude_deg == nullptr || longitude_deg == nullptr || ground == nullptr))
      return bad("latitude_deg, longitude_deg, ground: found NULL; allowed: n of each");
    wire::QueryGround request;
    request.set_radar(text_of(radar));
    const int count = static_cast<int>(std::min<std::size_t>(n, std::numeric_limits<int>::max()));
    request.mutable_latitude_deg()->Add(latitude_deg, latitude_deg + count);
    request.mutable_longitude_deg()->Add(longitude_deg, longitude_deg + count);
    if (height_m != nullptr) request.mutable_height_m()->Add(height_m, height_m + count);
    wire::GroundAnswer answer;
    std::vector<wire::GroundRecord> records;
    if (Status status = client->client.query_ground(request, answer, records); !status.ok()) return status;
    for (std::size_t k = 0; k < std::min(n, records.size()); ++k) {
      const wire::GroundRecord& r = records[k];
      ground[k] = {r.height_m,
                   r.surface_height_m,
                   static_cast<double>(r.slope_deg),
                   static_cast<double>(r.clearance_deg),
                   r.state == wire::GroundState::known,
                   seen(r.sight),
                   r.water,
                   r.building};
    }
    return Status{};
  });
}

int obliq_bookmark(obliq_client* client, const char* text) {
  return guarded(client, [&] { return client->client.add_bookmark(text_of(text)); });
}

int obliq_next_event(obliq_client* client, uint64_t after, obliq_event* event) {
  return guarded(client, [&] {
    if (event == nullptr) return bad("event: found NULL; allowed: a place for one");
    const auto behind = [&] {
      return std::ranges::find_if(client->events.events(), [&](const auto& e) { return e.number() > after; });
    };
    auto at = behind();
    // What is kept goes on from there, or the server is asked.
    if (at == client->events.events().end() ||
        (at == client->events.events().begin() && at->number() > after + 1)) {
      client->events.Clear();
      if (Status status = client->client.get_events(after, false, client->events); !status.ok())
        return status;
      at = behind();
    }
    const wire::ExerciseEvent& found =
        at == client->events.events().end() ? wire::ExerciseEvent::default_instance() : *at;
    *event = {found.number(),     found.utc_ns(),        static_cast<int>(found.kind()),
              found.by().c_str(), found.radar().c_str(), found.text().c_str()};
    return Status{};
  });
}

int obliq_go_to_event(obliq_client* client, uint64_t number) {
  return guarded(client, [&] {
    wire::SetReplay request;
    request.set_seek_bookmark(number);
    return client->client.set_replay(request);
  });
}

}  // extern "C"
