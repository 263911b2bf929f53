#include "server/control/settings_message.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <string>

#include "proto/obliq.pb.h"
#include "server/control/message_fields.h"
#include "server/control/parameters.h"
#include "server/control/planes_per_bin.h"

namespace obliq {

namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// The parameter's field. A table and a .proto that disagree are our mistake; a test compares them.
const FieldDescriptor& field_of(const Parameter& parameter, const Message& message) {
  return message_field(parameter.wire_field, message);
}

std::vector<FieldError> merge_fields(WireMessage which, const Message& message, RadarConfig& config) {
  std::vector<FieldError> errors;
  for (const Parameter& parameter : parameters()) {
    if (parameter.message != which) continue;
    const FieldDescriptor& field = field_of(parameter, message);
    if (!message.GetReflection()->HasField(message, &field)) continue;
    const Value value = read_field(parameter.key, field, message);
    if (auto error = store(parameter.key, parameter.slot(config), value)) errors.push_back(std::move(*error));
  }
  return errors;
}

void write_fields(WireMessage which, RadarConfig config, Message& message) {
  for (const Parameter& parameter : parameters()) {
    const Slot slot = parameter.slot(config);
    if (parameter.message == which && !is_left_open(slot))
      write_field(parameter.key, field_of(parameter, message), load(parameter.key, slot), message);
  }
}

}  // namespace

std::vector<FieldError> merge_message(const wire::RadarSettings& message, RadarSettings& settings) {
  RadarConfig config{"", settings, {}};
  std::vector<FieldError> errors = merge_fields(WireMessage::radar_settings, message, config);
  // A number without a word on its switch is meant.
  if (message.has_video_floor_db() && !message.has_video_floor_auto())
    config.settings.video.floor_auto = false;
  if (message.has_sea_state() && !message.has_sea_state_auto()) config.settings.sea.state_auto = false;
  settings = config.settings;
  return errors;
}

std::vector<FieldError> merge_request(const wire::RadarSettings& message, RadarSettings& settings) {
  std::vector<FieldError> errors = merge_message(message, settings);
  settle_planes(settings, message.has_pixel_columns());
  return errors;
}

std::vector<FieldError> merge_message(const wire::Pose& message, PoseSettings& pose) {
  RadarConfig config{"", {}, pose};
  // A number alone is meant to be taken.
  if (message.has_tilt_deg()) config.pose.tilt_auto = false;
  const auto ends = [&](const Parameter& p) {
    return ends_velocity(p) && message.GetReflection()->HasField(message, &field_of(p, message));
  };
  if (std::ranges::any_of(parameters(), ends)) config.pose.clear_velocity();
  std::vector<FieldError> errors = merge_fields(WireMessage::pose, message, config);
  pose = config.pose;
  return errors;
}

bool ends_velocity(const Parameter& parameter) {
  constexpr std::string_view kPlaceAndTime[] = {"latitude_deg", "longitude_deg", "height_m", "sim_time_ns"};
  return parameter.message == WireMessage::pose &&
         std::ranges::find(kPlaceAndTime, parameter.wire_field) != std::end(kPlaceAndTime);
}

void write_message(const RadarSettings& settings, wire::RadarSettings& message) {
  write_fields(WireMessage::radar_settings, {"", settings, {}}, message);
}

void write_request(const RadarSettings& settings, wire::RadarSettings& message) {
  write_message(settings, message);
  if (settings.frustum == FrustumKind::sweep && settings.planes_per_bin > 0) message.clear_pixel_columns();
}

void write_message(const PoseSettings& pose, wire::Pose& message) {
  write_fields(WireMessage::pose, {"", {}, pose}, message);
  if (!pose.has_velocity()) return;
  message.set_velocity_north_m_s(pose.velocity_north_m_s.value_or(0));
  message.set_velocity_east_m_s(pose.velocity_east_m_s.value_or(0));
  message.set_velocity_up_m_s(pose.velocity_up_m_s.value_or(0));
}

bool is_ideal(const wire::RadarSettings& message) {
  return std::ranges::none_of(parameters(), [&](const Parameter& p) {
    if (!p.meaning.not_ideal) return false;
    const FieldDescriptor& field = field_of(p, message);
    return message.GetReflection()->HasField(message, &field) &&
           read_field(p.key, field, message) != value_of(p, {});
  });
}

SettingsStore::SettingsStore(const RadarSettings& initial)
    : current_(std::make_shared<const SettingsSnapshot>(SettingsSnapshot{initial, 1})) {}

SettingsPtr SettingsStore::current() const {
  const std::lock_guard lock(mutex_);
  return current_;
}

SettingsStore::Outcome SettingsStore::update(
    const std::function<std::vector<FieldError>(RadarSettings&)>& edit) {
  const std::lock_guard lock(mutex_);
  RadarSettings candidate = current_->settings;
  std::vector<FieldError> errors = edit(candidate);
  for (FieldError& error : validate(candidate)) errors.push_back(std::move(error));
  if (!errors.empty()) return {nullptr, std::move(errors)};
  current_ = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{candidate, current_->version + 1});
  return {current_, {}};
}

SettingsStore::Outcome SettingsStore::set(const RadarSettings& settings) {
  return update([&](RadarSettings& candidate) {
    candidate = settings;
    return std::vector<FieldError>{};
  });
}

}  // namespace obliq
