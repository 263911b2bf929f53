#include "server/apps/commands/target_fields.h"

#include <fmt/core.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <fstream>
#include <optional>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/control/message_fields.h"
#include "server/control/sections/parameter_row.h"
#include "server/control/sections/targets.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

using google::protobuf::FieldDescriptor;

constexpr const char* kRoute = "route";
constexpr const char* kLoops = "route_loops";

bool is_key(const FieldDescriptor& field) { return field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE; }

std::string key_names() {
  std::string names;
  const auto* all = wire::Target::descriptor();
  for (int i = 0; i < all->field_count(); ++i)
    if (is_key(*all->field(i))) names += (names.empty() ? "" : ", ") + all->field(i)->name();
  return names + ", " + kRoute + ", " + kLoops;
}

Key key_of(const FieldDescriptor& field) { return {field.name(), "", kAny, kHeightReferences}; }

/// What is wrong with the value; nothing: the field has it.
std::optional<FieldError> set_field(wire::Target& target, const FieldDescriptor& field, const Value& value) {
  const Key key = key_of(field);
  const auto set = [&](auto held) {
    auto error = store(key, &held, value);
    if (!error) write_field(key, field, load(key, &held), target);
    return error;
  };
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return set(0.0);
    case FieldDescriptor::CPPTYPE_INT32:
      return set(0);
    case FieldDescriptor::CPPTYPE_INT64:
      return set(std::int64_t{});
    case FieldDescriptor::CPPTYPE_UINT64:
      return set(std::uint64_t{});
    case FieldDescriptor::CPPTYPE_STRING:
      return set(std::string{});
    default:
      return set(HeightReference{});
  }
}

void add_point(const RoutePoint& point, wire::Target& target) {
  wire::TargetRoute& route = *target.mutable_route();
  route.add_latitude_deg(point.latitude_deg);
  route.add_longitude_deg(point.longitude_deg);
  route.add_height_m(point.height_m.value_or(0));
  route.add_speed_m_s(point.speed_m_s);
}

RoutePoint read_point(const ConfigNode& table, Complaints& complaints) {
  RoutePoint point;
  for (const Row<RoutePoint>& row : route_rows()) {
    const ConfigNode* node = table.find(row.key.name);
    if (node == nullptr || store(row.key, row.slot(point), node->value) || is_left_open(row.slot(point)))
      complaints.add(table.where, FieldError{"target.route." + std::string(row.key.name),
                                             node == nullptr ? "nothing" : node->found_text(), "a number"});
  }
  return point;
}

RoutePoint point_of(const std::string& text) {
  double place[4] = {0, 0, 10, 0};
  std::size_t from = 0;
  int n = 0;
  for (; n < 4 && from <= text.size(); ++n) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const auto number = number_in(trimmed(text.substr(from, comma - from)));
    if (!number) n = -10;
    if (!number) break;
    place[n] = *number;
    from = comma + 1;
  }
  if (n < 2 || from <= text.size())
    throw InputError("route: found \"" + text + "\"; allowed: LATITUDE,LONGITUDE[,SPEED_M_S[,HEIGHT_M]]");
  return {place[0], place[1], place[3], place[2]};
}

std::string cell(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

std::string motion_text(const wire::Target& target) {
  if (target.has_route())
    return fmt::format("route of {} points{}", target.route().latitude_deg_size(),
                       target.route().loops() ? ", loops" : "");
  const double north = target.velocity_north_m_s(), east = target.velocity_east_m_s();
  const double speed = std::hypot(north, east);
  if (speed == 0) return "stands";
  const double course_deg = std::atan2(east, north) / kDegree_rad;
  return fmt::format("{:.1f} m/s, course {:03.0f}", speed, course_deg < 0 ? course_deg + 360 : course_deg);
}

}  // namespace

std::string target_text(const wire::Target& target) {
  std::string text;
  const auto* all = wire::Target::descriptor();
  for (int i = 0; i < all->field_count(); ++i) {
    const FieldDescriptor* field = all->field(i);
    if (!is_key(*field) || (field->has_presence() && !target.GetReflection()->HasField(target, field)))
      continue;
    text += field->name() + " = " + toml_text(read_field(key_of(*field), *field, target)) + "\n";
  }
  if (!target.has_route()) return text;
  const wire::TargetRoute& route = target.route();
  text += std::string(kLoops) + " = " + (route.loops() ? "true" : "false") + "\n";
  for (int k = 0; k < route.latitude_deg_size(); ++k)
    text += "[[target.route]]\nlatitude_deg = " + toml_number(route.latitude_deg(k)) +
            "\nlongitude_deg = " + toml_number(route.longitude_deg(k)) +
            "\nheight_m = " + toml_number(route.height_m_size() > k ? route.height_m(k) : target.height_m()) +
            "\nspeed_m_s = " + toml_number(route.speed_m_s(route.speed_m_s_size() > k ? k : 0)) + "\n";
  return text;
}

void read_target(const ConfigNode& table, wire::Target& target, Complaints& complaints) {
  for (const ConfigNode& node : table.items) {
    const std::string name = "target." + node.key;
    if (node.key == kRoute && node.kind == ConfigNode::Kind::array) {
      for (const ConfigNode& point : node.items) add_point(read_point(point, complaints), target);
      continue;
    }
    if (node.key == kLoops) {
      if (const auto* loops = std::get_if<bool>(&node.value)) {
        target.mutable_route()->set_loops(*loops);
      } else {
        complaints.add(node.where, FieldError{name, node.found_text(), "true or false"});
      }
      continue;
    }
    const auto* field = wire::Target::descriptor()->FindFieldByName(node.key);
    if (field == nullptr || !is_key(*field)) {
      complaints.add(node.where, FieldError{name, "a key that is none", key_names()});
    } else if (node.kind != ConfigNode::Kind::value) {
      complaints.add(node.where, FieldError{name, node.found_text(), "a value"});
    } else if (const auto error = set_field(target, *field, node.value)) {
      complaints.add(node.where, FieldError{name, node.found_text(), error->allowed});
    }
  }
}

std::vector<wire::Target> targets_of_words(const std::vector<std::string>& words) {
  std::vector<wire::Target> targets;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals == std::string::npos || (name != "id" && targets.empty()))
      throw InputError("found \"" + word + "\"; allowed: KEY=VALUE, id=N first; keys: " + key_names());
    if (name == "id") targets.emplace_back();
    const std::string text = word.substr(equals + 1);
    if (name == kRoute) {
      add_point(point_of(text), targets.back());
      continue;
    }
    Complaints complaints;
    ConfigNode table;
    table.items.push_back(parse_config_value(text, word));
    table.items.back().key = name;
    const auto* field = wire::Target::descriptor()->FindFieldByName(name);
    if (field != nullptr && field->cpp_type() == FieldDescriptor::CPPTYPE_STRING)
      table.items.back().value = text;  // a name may look like a number
    read_target(table, targets.back(), complaints);
    complaints.throw_if_any();
  }
  return targets;
}

std::vector<wire::Target> targets_of_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  std::vector<wire::Target> targets;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (trimmed(line).empty()) continue;
    const auto parsed = google::protobuf::util::JsonStringToMessage(line, &targets.emplace_back());
    if (!parsed.ok())
      throw InputError(
          fmt::format("{}:{}: found {}; allowed: a target as JSON, a line each, as `obliq targets "
                      "--json` prints them",
                      path, number, std::string(parsed.message())));
  }
  if (targets.empty()) throw InputError(path + ": found no target; allowed: a target as JSON, a line each");
  return targets;
}

std::string target_table(const wire::TargetList& list) {
  std::string text =
      fmt::format("{:>10}  {:20} {:12} {:>11} {:>12} {:>9} {:9} {:>6} {:>2}  {}\n", "id", "name", "type",
                  "latitude", "longitude", "height m", "over", "dB m^2", "Sw", "motion");
  for (const wire::Target& target : list.targets())
    text += fmt::format("{:>10}  {:20} {:12} {:>11} {:>12} {:>9} {:9} {:>6} {:>2}  {}\n", target.id(),
                        printable_text(target.name(), 20), printable_text(target.type(), 12),
                        cell(target.latitude_deg(), 6), cell(target.longitude_deg(), 6),
                        cell(target.height_m(), 1),
                        wire::enum_word(wire::HeightReference_Name(target.height_reference())),
                        cell(target.rcs_dbsm(), 1), target.swerling(), motion_text(target));
  return text;
}

}  // namespace obliq
