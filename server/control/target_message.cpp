#include "server/control/target_message.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/message_fields.h"
#include "server/control/sections/targets.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

/// Of the table of targets' keys, what a message says in its own way.
bool is_time(const Key& key) { return key.name == "sim_time_ns"; }
bool is_velocity(const Key& key) {
  return key.name.starts_with("velocity_") || key.name.starts_with("acceleration_");
}
bool is_place(const Key& key) {
  return key.name == "latitude_deg" || key.name == "longitude_deg" || key.name == "height_m" ||
         key.name == "height_reference" || key.name == "geoid_undulation_m";
}

bool has(const wire::Target& message, const Key& key) {
  return message.GetReflection()->HasField(message, &message_field(key.name, message));
}

bool says(const wire::Target& message, bool (*which)(const Key&)) {
  return std::ranges::any_of(target_rows(),
                             [&](const Row<Target>& row) { return which(row.key) && has(message, row.key); });
}

std::vector<FieldError> read_route(const wire::TargetRoute& message, RouteSpec& route) {
  const int n = message.latitude_deg_size();
  std::vector<FieldError> errors;
  const auto demand = [&](const char* field, int found, bool fits, const std::string& allowed) {
    if (!fits) errors.push_back({std::string("route.") + field, std::to_string(found) + " values", allowed});
  };
  const std::string as_many = std::to_string(n) + ", as many as latitudes";
  demand("longitude_deg", message.longitude_deg_size(), message.longitude_deg_size() == n, as_many);
  demand("height_m", message.height_m_size(), message.height_m_size() == n || message.height_m_size() == 0,
         as_many + ", or none");
  demand("speed_m_s", message.speed_m_s_size(),
         message.speed_m_s_size() == n || message.speed_m_s_size() == 1 || n == 0,
         as_many + ", or one for all");
  if (n > static_cast<int>(kMostRoutePoints))
    errors.push_back({"route", std::to_string(n) + " points", "at most " + std::to_string(kMostRoutePoints)});
  if (!errors.empty()) return errors;
  route = {{}, message.loops()};
  for (int k = 0; k < n; ++k) {
    RoutePoint point{message.latitude_deg(k), message.longitude_deg(k), {}, 0};
    if (message.height_m_size() == n) point.height_m = message.height_m(k);
    point.speed_m_s = message.speed_m_s(message.speed_m_s_size() == 1 ? 0 : k);
    route.points.push_back(point);
  }
  return {};
}

void write_route(const TargetConfig& target, wire::TargetRoute& message) {
  message.set_loops(target.route.loops);
  for (const RoutePoint& point : target.route.points) {
    message.add_latitude_deg(point.latitude_deg);
    message.add_longitude_deg(point.longitude_deg);
    message.add_height_m(point.height_m.value_or(target.target.height_m));
    message.add_speed_m_s(point.speed_m_s);
  }
}

}  // namespace

bool says_motion(const wire::Target& message) {
  return says(message, is_place) || says(message, is_velocity) || message.has_route();
}

std::vector<FieldError> merge_message(const wire::Target& message, const std::vector<TargetType>& types,
                                      TargetConfig& target) {
  std::vector<FieldError> errors;
  if (message.has_name()) {
    target.name = message.name();
    if (target.name.size() > wire::kMaxNameBytes)
      errors.push_back({"name", std::to_string(target.name.size()) + " bytes",
                        "at most " + std::to_string(wire::kMaxNameBytes)});
  }
  if (message.has_type() && message.type() != target.type) {
    const TargetType* type = find_type(types, message.type());
    if (type != nullptr) target.target.size = type->size;
    if (type == nullptr && !message.type().empty())
      errors.push_back({"type", toml_string(printable_text(message.type(), 64)), allowed_types(types)});
    target.type = message.type();
  }
  if (message.has_route()) {
    append(errors, read_route(message.route(), target.route));
    // What moved it straight on has ended; a velocity in the same message is a mistake.
    target.target.velocity_m_s = target.target.acceleration_m_s2 = glm::dvec3(0.0);
  } else if (says(message, is_place) || says(message, is_velocity)) {
    target.route = {};
  }
  for (const Row<Target>& row : target_rows()) {
    if (is_time(row.key) || !has(message, row.key)) continue;
    const Value value = read_field(row.key, message_field(row.key.name, message), message);
    if (auto error = store(row.key, row.slot(target.target), value)) errors.push_back(std::move(*error));
  }
  if (message.has_rcs_dbsm()) target.target.size.aspects = nullptr;
  append(errors, validate(target));
  if (errors.empty() && says_motion(message)) target.lay_route();
  return errors;
}

void write_message(const TargetConfig& target, wire::Target& message) {
  message.set_id(target.target.id);
  message.set_name(target.name);
  message.set_type(target.type);
  Target object = target.target;
  for (const Row<Target>& row : target_rows()) {
    const Slot slot = row.slot(object);
    if (is_from_aspects(row.key, object)) continue;
    if (is_time(row.key) || is_left_open(slot) || (target.target.route && is_velocity(row.key))) continue;
    write_field(row.key, message_field(row.key.name, message), load(row.key, slot), message);
  }
  if (target.target.route) write_route(target, *message.mutable_route());
}

void write_message(const TargetType& type, wire::TargetType& message) {
  message.set_name(type.name);
  message.set_rcs_dbsm(type.size.rcs_dbsm);
  message.set_swerling(type.size.swerling);
  message.set_length_m(type.size.length_m);
  message.set_width_m(type.size.width_m);
  message.set_top_m(type.size.top_m);
  message.mutable_dis()->Assign(type.dis.begin(), type.dis.end());
}

TargetType read_message(const wire::TargetType& message) {
  return {message.name(),
          {message.rcs_dbsm(), message.swerling(), message.length_m(), message.width_m(), message.top_m()},
          {message.dis().begin(), message.dis().end()}};
}

}  // namespace obliq
