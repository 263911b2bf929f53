// Requests for frames.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/key.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/requests/request_limits.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

using wire::ErrorNumber;

namespace {

std::vector<double> values(const google::protobuf::RepeatedField<double>& field) {
  return {field.begin(), field.end()};
}

/// The antenna of the query's own, in place of a radar's.
PoseSettings read_antenna(const wire::Pose& message, std::vector<FieldError>& errors) {
  PoseSettings antenna;
  for (const FieldError& missing : missing_position(message))
    errors.push_back({"antenna." + missing.field, missing.found, "a value: an antenna stands somewhere"});
  append(errors, merge_message(message, antenna));
  append(errors, validate(antenna));
  return antenna;
}

/// RenderOnce may name no radar of ours; the name is echoed.
constexpr std::size_t kMaxEchoedName = 256;

}  // namespace

void Requests::subscribe(const wire::Subscribe& request) {
  LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  const ServerOptions& options = room_.options();
  std::vector<FieldError> errors;
  const double rate_hz = request.rate_hz();
  if (!(rate_hz >= kLeastRate_hz && rate_hz <= options.max_rate_hz))
    errors.push_back({"rate_hz", toml_number(rate_hz),
                      toml_number(kLeastRate_hz) + " to " + toml_number(options.max_rate_hz)});
  const RadarSettings& settings = radar->settings.current()->settings;
  rendering::Demand demanded;
  demanded.rate_hz = rate_hz;
  demanded.lossless = request.lossless();
  demanded.choice = stream::read_choice(request, settings.azimuth_bins, settings.range_bins, errors);
  demanded.choice.as_json = peer_.takes_json;
  if ((demanded.choice.planes & ~room_.renderer().planes()) != 0)
    errors.push_back(
        {"planes", wire::plane_names(demanded.choice.planes), wire::plane_names(room_.renderer().planes())});
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "subscription refused", errors);
  if (stream::tells_truth(demanded.choice) && !demand_truth()) return;
  if (demanded.lossless && !demand(security::Role::controller, "watching without losses")) return;
  if (const auto over = room_.over_live_limit(settings, demanded.choice.planes)) return refuse(*over);
  const bool renewed = peer_.outbox.has_queue(radar->stream_id);
  if (!renewed && peer_.subscriptions >= options.max_subscriptions)
    return refuse(ErrorNumber::too_many_subscriptions, "too many subscriptions: max_subscriptions is " +
                                                           std::to_string(options.max_subscriptions));
  room_.radars().unsubscribe(*radar, peer_);
  room_.radars().watch(*radar, peer_, std::move(demanded));
  acknowledge(radar->settings.current()->version);
  room_.watchers_changed(true);
  if (!radar->faults.empty()) room_.radars().send_fault(*radar, peer_);
}

void Requests::unsubscribe(const wire::Unsubscribe& request) {
  LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  if (!peer_.outbox.has_queue(radar->stream_id))
    return refuse(ErrorNumber::not_subscribed, "not subscribed to radar " + radar->name);
  room_.radars().unsubscribe(*radar, peer_);
  room_.watchers_changed(false);
  acknowledge();
}

void Requests::render_once(const wire::RenderOnce& request) {
  const ServerOptions& options = room_.options();
  if (peer_.renders.size() >= static_cast<std::size_t>(options.max_renders_queued))
    return refuse(ErrorNumber::too_many_renders, "too many unfinished renders: max_renders_queued is " +
                                                     std::to_string(options.max_renders_queued));
  RadarSettings settings;
  PoseSettings pose;
  std::vector<FieldError> errors;
  const LiveRadar* like =
      request.as_live() ? radar_of(request.radar()) : room_.radars().find(request.radar());
  if (request.as_live()) {
    if (like == nullptr) return;  // refused
    settings = like->settings.current()->settings;
    pose = like->shown().pose;
  } else {
    errors = missing_position(request.pose());
    // Tables come from the scene file: those of the radar that the frame is to be like.
    if (like != nullptr) settings.beam.file = like->settings.current()->settings.beam.file;
  }
  std::vector<Target> targets;
  append(errors, room_.targets().read(request, targets));
  append(errors, merge_request(request.settings(), settings));
  append(errors, merge_message(request.pose(), pose));
  append(errors, validate(settings));
  append(errors, validate(pose));
  if (request.radar().size() > kMaxEchoedName)
    errors.push_back({"radar", std::to_string(request.radar().size()) + " bytes",
                      "a name of at most " + std::to_string(kMaxEchoedName) + " bytes"});
  stream::StreamChoice choice;
  if (errors.empty())
    choice = stream::read_choice(request, settings.azimuth_bins, settings.range_bins, errors);
  if (errors.empty() && (choice.planes & wire::kPulsesPlane) != 0 && settings.mode != RadarMode::pulses)
    errors.push_back({"planes", wire::plane_names(choice.planes) + " of another radar.mode",
                      "pulses with radar.mode = \"pulses\" alone"});
  choice.as_json = peer_.takes_json;
  // Truth of the request's own targets tells nothing that the client does not know.
  if (stream::tells_truth(choice) && request.live_targets() && !demand_truth()) return;
  if (errors.empty()) errors = room_.renderer().place(pose);
  if (errors.empty()) errors = room_.renderer().scene_faults(settings);
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "frame refused", errors);

  const rendering::FrameCost cost = once_cost(settings, choice.planes, options);
  const rendering::FrameCost queued = room_.cost_queued();
  if (const auto over = over_limit(settings, cost, queued.bytes, options)) return refuse(*over);
  if (const auto over = over_queue(cost, queued.work(), options)) return refuse(*over);
  const auto faults = beam_faults_of(settings, 0, pose);
  if (!faults) return;
  if (!faults->empty()) return refuse(ErrorNumber::invalid_value, "frame refused", *faults);

  auto render = std::make_shared<rendering::FrameRequest>();
  render->request_id = id_;
  render->radar = request.radar();
  render->view.settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 0});
  render->view.pose = pose;
  render->view.pose_received_ns = stream::monotonic_ns();
  render->targets = room_.targets().of_one_frame(targets, request.live_targets());
  render->view.targets_at = {room_.targets().now_ns(), request.pose().has_sim_time_ns()};
  if (request.as_live() && !request.pose().has_sim_time_ns())
    render->view.targets_at = like->view().at(room_.targets().now_ns()).targets_at;
  render->choice = choice;
  render->cost = cost;
  room_.render_once(peer_, render);
  acknowledge();
}

using wire::ErrorNumber;

void Requests::query_ground(const wire::QueryGround& request) {
  const ServerOptions& options = room_.options();
  if (!options.query_ground)
    return refuse(ErrorNumber::render_failed, "this server has no ground that could be queried");
  if (peer_.queries >= options.max_renders_queued)
    return refuse(ErrorNumber::too_many_renders, "too many unanswered queries: max_renders_queued is " +
                                                     std::to_string(options.max_renders_queued));
  const int most = std::max({request.latitude_deg_size(), request.longitude_deg_size(),
                             request.bearing_deg_size(), request.range_m_size(), request.height_m_size()});
  if (most > static_cast<int>(wire::kMaxQueryPoints)) {
    const std::string limit = std::to_string(wire::kMaxQueryPoints);
    return refuse({"max_query_points",
                   "max_query_points is " + limit + ": ask for more in several queries",
                   {"points", std::to_string(most), "1 to " + limit}});
  }

  auto question = std::make_shared<GroundQuestion>();
  std::vector<FieldError> errors;
  if (!request.radar().empty()) {
    LiveRadar* radar = radar_of(request.radar());
    if (radar == nullptr) return;
    question->antenna = radar->shown().pose;
    if (request.has_antenna())
      errors.push_back({"antenna", "one, and the radar \"" + radar->name + "\"", "one of the two, or none"});
  } else if (request.has_antenna()) {
    question->antenna = read_antenna(request.antenna(), errors);
  }
  question->latitude_deg = values(request.latitude_deg());
  question->longitude_deg = values(request.longitude_deg());
  question->bearing_deg = values(request.bearing_deg());
  question->range_m = values(request.range_m());
  question->height_m = values(request.height_m());
  question->geoid_undulation_m = request.geoid_undulation_m();
  switch (request.height_reference()) {
    case wire::DATUM:
      question->height_reference = HeightReference::datum;
      break;
    case wire::GROUND:
      question->height_reference = HeightReference::ground;
      break;
    case wire::ELLIPSOID:
      question->height_reference = HeightReference::ellipsoid;
      break;
    default:
      errors.push_back({"height_reference", std::to_string(static_cast<int>(request.height_reference())),
                        "DATUM (0), GROUND (1) or ELLIPSOID (2)"});
  }
  append(errors, faults_of(*question));
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "query refused", errors);
  room_.query_ground(peer_, id_, std::move(question));
}

}  // namespace obliq::net
