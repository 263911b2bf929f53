// Requests for frames.
#include <string>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/key.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/request_limits.h"
#include "server/net/requests.h"
#include "server/net/room.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

using wire::ErrorNumber;

namespace {

/// RenderOnce names no radar of ours; the name is only echoed.
constexpr std::size_t kMaxEchoedName = 256;

}  // namespace

void Requests::subscribe(const wire::Subscribe& request) {
  LiveRadar* radar = radar_of(request.request_id(), request.radar());
  if (radar == nullptr) return;
  const ServerOptions& options = room_.options();
  std::vector<FieldError> errors;
  const double rate_hz = request.rate_hz();
  if (!(rate_hz >= kLeastRate_hz && rate_hz <= options.max_rate_hz)) {
    errors.push_back({"rate_hz", toml_number(rate_hz),
                      toml_number(kLeastRate_hz) + " to " + toml_number(options.max_rate_hz)});
  }
  const RadarSettings& settings = radar->settings.current()->settings;
  Demand demanded;
  demanded.rate_hz = rate_hz;
  demanded.lossless = request.lossless();
  demanded.choice = read_choice(request, settings.azimuth_bins, settings.range_bins, errors);
  demanded.choice.as_json = peer_.takes_json;
  if ((demanded.choice.planes & ~room_.renderer().planes()) != 0) {
    errors.push_back(
        {"planes", wire::plane_names(demanded.choice.planes), wire::plane_names(room_.renderer().planes())});
  }
  if (!errors.empty()) {
    return refuse(request.request_id(), ErrorNumber::invalid_value, "subscription refused", errors);
  }
  if (demanded.lossless && !demand(Role::controller, request.request_id(), "watching without losses")) return;
  if (const auto over = room_.over_live_limit(settings, demanded.choice.planes)) {
    return refuse(request.request_id(), *over);
  }
  const bool renewed = peer_.outbox.has_queue(radar->stream_id);
  if (!renewed && peer_.subscriptions >= options.max_subscriptions) {
    return refuse(
        request.request_id(), ErrorNumber::too_many_subscriptions,
        "too many subscriptions: max_subscriptions is " + std::to_string(options.max_subscriptions));
  }
  room_.radars().unsubscribe(*radar, peer_);
  room_.radars().watch(*radar, peer_, std::move(demanded));
  acknowledge(request.request_id(), radar->settings.current()->version);
  room_.watchers_changed(true);
  if (!radar->faults.empty()) room_.radars().send_fault(*radar, peer_);
}

void Requests::unsubscribe(const wire::Unsubscribe& request) {
  LiveRadar* radar = radar_of(request.request_id(), request.radar());
  if (radar == nullptr) return;
  if (!peer_.outbox.has_queue(radar->stream_id)) {
    return refuse(request.request_id(), ErrorNumber::not_subscribed,
                  "not subscribed to radar " + radar->name);
  }
  room_.radars().unsubscribe(*radar, peer_);
  room_.watchers_changed(false);
  acknowledge(request.request_id());
}

void Requests::render_once(const wire::RenderOnce& request) {
  const ServerOptions& options = room_.options();
  if (peer_.renders.size() >= static_cast<std::size_t>(options.max_renders_queued)) {
    return refuse(
        request.request_id(), ErrorNumber::too_many_renders,
        "too many unfinished renders: max_renders_queued is " + std::to_string(options.max_renders_queued));
  }
  RadarSettings settings;
  PoseSettings pose;
  std::vector<FieldError> errors = missing_position(request.pose());
  append(errors, merge_message(request.settings(), settings));
  // Tables come from the scene file: those of the radar that the frame is to be like.
  if (const LiveRadar* like = room_.radars().find(request.radar()))
    settings.beam.file = like->settings.current()->settings.beam.file;
  append(errors, merge_message(request.pose(), pose));
  append(errors, validate(settings));
  append(errors, validate(pose));
  if (request.radar().size() > kMaxEchoedName) {
    errors.push_back({"radar", std::to_string(request.radar().size()) + " bytes",
                      "a name of at most " + std::to_string(kMaxEchoedName) + " bytes"});
  }
  StreamChoice choice;
  if (errors.empty()) choice = read_choice(request, settings.azimuth_bins, settings.range_bins, errors);
  choice.as_json = peer_.takes_json;
  if (errors.empty()) errors = room_.renderer().place(pose);
  if (errors.empty()) errors = room_.renderer().scene_faults(settings);
  if (!errors.empty())
    return refuse(request.request_id(), ErrorNumber::invalid_value, "frame refused", errors);

  const FrameCost cost = once_cost(settings, choice.planes, options);
  const FrameCost queued = room_.cost_queued();
  if (const auto over = over_limit(settings, cost, queued.bytes, options)) {
    return refuse(request.request_id(), *over);
  }
  if (const auto over = over_queue(cost, queued.work(), options)) return refuse(request.request_id(), *over);
  const auto faults = beam_faults_of(settings, 0, pose);
  if (!faults) return;
  if (!faults->empty())
    return refuse(request.request_id(), ErrorNumber::invalid_value, "frame refused", *faults);

  auto render = std::make_shared<OnceRequest>();
  render->request_id = request.request_id();
  render->radar = request.radar();
  render->view.settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 0});
  render->view.pose = pose;
  render->view.pose_received_ns = monotonic_ns();
  render->choice = choice;
  render->cost = cost;
  room_.render_once(peer_, render);
  acknowledge(request.request_id());
}

}  // namespace obliq::net
