#include "server/control/sections/targets.h"

#include <algorithm>
#include <array>
#include <set>

#include "server/control/sections/dis_pattern.h"
#include "server/control/sections/parameter_row.h"
#include "server/control/sections/platform.h"
#include "server/control/sections/section.h"
#include "server/control/sections/special_values.h"
#include "server/radar/targets/aspect_table.h"

namespace obliq {
namespace {

using Of = RowsOf<Change::restart, &TargetType::size>;
using Its = RowsOf<Change::restart>;
constexpr Limits kSpeed = closed(-kMostSpeed_m_s, kMostSpeed_m_s);
constexpr Limits kPush = closed(-kMostTargetAcceleration_m_s2, kMostTargetAcceleration_m_s2);
constexpr Limits kExtent = closed(0, 1000);
constexpr Limits kLatitude = closed(-90, 90);
constexpr Limits kLongitude = closed(-360, 360);
constexpr Limits kHeight = closed(kLeastTargetHeight_m, kMostTargetHeight_m);
constexpr std::size_t kMost = 10000;

/// The keys of a type, which a target may set for itself.
template <class Rows, auto... to>
constexpr auto size_rows() {
  return std::array{
      Rows::template row<to..., &TargetSize::rcs_dbsm>("rcs_dbsm", "dB m^2", closed(-100, 100),
                                                       "Mean radar cross section."),
      Rows::template row<to..., &TargetSize::swerling>(
          "swerling", "", closed(0, 4),
          "Swerling's case: 0 steady; 1 and 2 of many scatterers; 3 and 4 of one large one among many; 1 and "
          "3 stay for a pass or a frame, 2 and 4 for a dwell."),
      Rows::template row<to..., &TargetSize::length_m>(
          "length_m", "m", kExtent, "Length of what echoes; 0: a point. Swerling 0, 3 and 4 are points."),
      Rows::template row<to..., &TargetSize::width_m>("width_m", "m", kExtent, "Its width."),
      Rows::template row<to..., &TargetSize::top_m>("top_m", "m", kExtent,
                                                    "Height over its foot: what a hill must hide."),
  };
}

constexpr std::array kTypeRows = size_rows<Of>();

void read_rcs_file(const FoundKey& found, TargetType& type) {
  if (found.text() == nullptr) return found.refuse();
  type.rcs_file = resolved_path(found.node, found.scene.folder);
}

void read_dis(const FoundKey& found, TargetType& type) {
  for (const ConfigNode* node : found.reader.texts(found.name)) {
    const auto& text = std::get<std::string>(node->value);
    if (DisPattern::parse(text)) {
      type.dis.push_back(text);
    } else {
      found.reader.complain(*node, found.name, DisPattern::kAllowed);
    }
  }
}

std::string printed_dis(const TargetType& type, const SceneConfig&) {
  return type.dis.empty() ? "" : toml_list(type.dis, toml_string);
}

const std::array kTypeSpecial{
    special<TargetType>(
        "rcs_file", "", kAny, "path",
        "CSV with the heading aspect_deg,elevation_deg,rcs_dbsm in place of rcs_dbsm: aspect clockwise from "
        "the nose, "
        "0 to 180 alone for both sides; elevation of the radar over the target's level.",
        read_rcs_file,
        [](const TargetType& type, const SceneConfig&) {
          return type.rcs_file.empty() ? std::string() : toml_string(type.rcs_file);
        },
        "", Change::restart),
    special<TargetType>(
        "dis", "", kAny,
        "a list of entity types, such as \"1.1.225.7\"; \"*\" stands for any number, and so does "
        "what is left out at the end",
        "Entities of DIS that are such targets; where several types fit, the one that says "
        "most numbers.",
        read_dis, printed_dis, "[]", Change::restart),
};

constexpr std::array kPlaceRows{
    Its::row<&Target::latitude_deg>("latitude_deg", "deg", kLatitude, "Where it is."),
    Its::row<&Target::longitude_deg>("longitude_deg", "deg", kLongitude, "Where it is."),
    Its::row<&Target::height_m>("height_m", "m", kHeight, "Of its foot, over the reference."),
    Its::row<&Target::height_reference>(
        "height_reference", "", kHeightReferences,
        "What the height counts from: the ground as it is loaded, the datum or the ellipsoid."),
    Its::row<&Target::geoid_undulation_m>(
        "geoid_undulation_m", "m", closed(-200, 200),
        "Of the geoid over the ellipsoid, for a height over the ellipsoid."),
    Its::row<&Target::velocity_m_s, &glm::dvec3::z>("velocity_north_m_s", "m/s", kSpeed,
                                                    "Along its own north."),
    Its::row<&Target::velocity_m_s, &glm::dvec3::x>("velocity_east_m_s", "m/s", kSpeed,
                                                    "Along its own east."),
    Its::row<&Target::velocity_m_s, &glm::dvec3::y>("velocity_up_m_s", "m/s", kSpeed, "Upwards."),
    Its::row<&Target::acceleration_m_s2, &glm::dvec3::z>("acceleration_north_m_s2", "m/s^2", kPush,
                                                         "Along its own north."),
    Its::row<&Target::acceleration_m_s2, &glm::dvec3::x>("acceleration_east_m_s2", "m/s^2", kPush,
                                                         "Along its own east."),
    Its::row<&Target::acceleration_m_s2, &glm::dvec3::y>("acceleration_up_m_s2", "m/s^2", kPush, "Upwards."),
    Its::row<&Target::heading_deg>(
        "heading_deg", "deg", closed(-360, 360),
        "Where its nose points, clockwise from north; left out: along its course."),
    Its::row<&Target::heading_rate_deg_s>("heading_rate_deg_s", "deg/s",
                                          closed(-kMostHeadingRate_deg_s, kMostHeadingRate_deg_s),
                                          "How fast it turns."),
    Its::row<&Target::sim_time_ns>("sim_time_ns", "ns", closed(-4e18, 4e18),
                                   "Of place, velocity and heading, in the clock of the poses."),
};

constexpr std::array kOwnRows = size_rows<Its, &Target::size>();

constexpr std::array kRows = [] {
  std::array<Row<Target>, kPlaceRows.size() + kOwnRows.size()> all{};
  std::ranges::copy(kOwnRows, std::ranges::copy(kPlaceRows, all.begin()).out);
  return all;
}();

constexpr std::array kConfigRows{
    RowsOf<Change::restart>::row<&TargetConfig::route, &RouteSpec::loops>(
        "route_loops", "From the last point of its route back to the beginning, and so on."),
};

using Point = RowsOf<Change::restart>;
constexpr std::array kRouteRows{
    Point::row<&RoutePoint::latitude_deg>("latitude_deg", "deg", kLatitude, "Where it goes next."),
    Point::row<&RoutePoint::longitude_deg>("longitude_deg", "deg", kLongitude, "Where it goes next."),
    Point::row<&RoutePoint::height_m>("height_m", "m", kHeight,
                                      "Of its foot there, over the target's reference; left out: its own."),
    Point::row<&RoutePoint::speed_m_s>("speed_m_s", "m/s", above(0, kMostSpeed_m_s),
                                       "On the way to it; left out: as on the way before, of the first 10."),
};

constexpr std::array kTargetsRows{
    Its::row<&SceneConfig::target_seed>("targets.seed", kAny,
                                        "Each seed gives targets another fluctuation and other phases."),
};

}  // namespace

const Section kTargetsSection{"targets", {kTargetsRows}};

Keys<TargetType> target_type_keys() { return {kTypeRows, kTypeSpecial}; }
std::span<const Row<Target>> target_rows() { return kRows; }
std::span<const Row<TargetConfig>> target_config_rows() { return kConfigRows; }
std::span<const Row<RoutePoint>> route_rows() { return kRouteRows; }

const TargetType* find_type(const std::vector<TargetType>& types, const std::string& name) {
  const auto type = std::ranges::find(types, name, &TargetType::name);
  return type == types.end() ? nullptr : &*type;
}

std::string allowed_types(const std::vector<TargetType>& types) {
  if (types.empty()) return "the name of a table [target_types.NAME], of which the scene has none";
  std::string names;
  for (const TargetType& each : types) names += (names.empty() ? "one of " : ", ") + toml_string(each.name);
  return names;
}

void TargetConfig::lay_route() {
  target.route =
      route.points.empty()
          ? nullptr
          : std::make_shared<const Route>(target.latitude_deg, target.longitude_deg, target.height_m, route);
}

namespace {

template <class T>
void check_rows(std::span<const Row<T>> rows, T& object, const std::string& prefix,
                std::vector<FieldError>& errors) {
  for (const Row<T>& row : rows)
    if (auto error = check(row.key, row.slot(object))) {
      error->field = prefix + std::string(row.key.name);
      errors.push_back(std::move(*error));
    }
}

}  // namespace

std::vector<FieldError> validate(const TargetConfig& config) {
  TargetConfig checked = config;
  std::vector<FieldError> errors;
  check_rows<Target>(kRows, checked.target, "", errors);
  for (std::size_t k = 0; k < checked.route.points.size() && errors.size() < 20; ++k)
    check_rows<RoutePoint>(kRouteRows, checked.route.points[k], "route[" + std::to_string(k) + "].", errors);
  if (config.route.points.size() > kMostRoutePoints)
    errors.push_back({"route", std::to_string(config.route.points.size()) + " points",
                      "at most " + std::to_string(kMostRoutePoints)});
  const glm::dvec3 none(0.0);
  if (!config.route.points.empty() &&
      (config.target.velocity_m_s != none || config.target.acceleration_m_s2 != none))
    errors.push_back(
        {"route", "a velocity beside it", "a route or a velocity: a route has speeds of its own"});
  return errors;
}

namespace {

void load_aspects(SceneReading& scene, const ConfigNode& table, TargetType& type) {
  if (type.rcs_file.empty()) return;
  try {
    type.size.aspects = std::make_shared<const AspectTable>(AspectTable::read(type.rcs_file));
  } catch (const InputError& error) {
    scene.complaints.add(table.where + ": target_types." + toml_key(type.name) + ": " + error.what());
    return;
  }
  type.size.rcs_dbsm = type.size.aspects->mean_dbsm();
  if (type.size.aspects->is_all_positive())
    scene.config.notes.push_back(
        type.rcs_file + ": no value is below 0 dB m^2: if they are areas in m^2, write 10 log10 of them");
}

}  // namespace

void read_target_types(SceneReading& scene) {
  scene.top.one_table("target_types", [&](const ConfigNode& all) {
    for (const ConfigNode& table : all.items) {
      const std::string full_name = "target_types." + toml_key(table.key);
      if (table.kind != ConfigNode::Kind::table || table.key.empty() || table.key.size() > 64) {
        scene.complaints.add(table.where, {full_name, table.found_text(), "a table [target_types.NAME]"});
        continue;
      }
      TargetType type;
      type.name = table.key;
      SectionReader reader(table, full_name, scene.complaints);
      read_keys<TargetType>(scene, reader, target_type_keys(), "", type);
      reader.finish();
      load_aspects(scene, table, type);
      scene.config.target_types.push_back(std::move(type));
    }
    std::ranges::sort(scene.config.target_types, {}, &TargetType::name);
  });
}

std::vector<TargetType> read_type_file(const ConfigNode& root) {
  SceneConfig config;
  Complaints complaints;
  SectionReader top(root, "", complaints);
  SceneReading scene{config, top, complaints, {}};
  read_target_types(scene);
  top.finish();
  complaints.throw_if_any();
  return std::move(config.target_types);
}

namespace {

void read_type(SceneReading& scene, SectionReader& reader, TargetConfig& target) {
  reader.read("type", Key{"target.type", ""}, &target.type);
  const std::vector<TargetType>& types = scene.config.target_types;
  if (const TargetType* type = find_type(types, target.type)) {
    target.target.size = type->size;
    return;
  }
  const ConfigNode* node = reader.table().find("type");
  scene.complaints.add(
      node != nullptr ? node->where : reader.table().where,
      {"target.type", node != nullptr ? node->found_text() : "nothing", allowed_types(types)});
}

void read_route(SceneReading& scene, SectionReader& reader, TargetConfig& config) {
  read_keys<TargetConfig>(scene, reader, {kConfigRows}, "", config);
  double speed_m_s = RoutePoint{}.speed_m_s;
  reader.each_table("route", [&](const ConfigNode& table) {
    RoutePoint point;
    point.speed_m_s = speed_m_s;
    SectionReader its(table, "target.route", scene.complaints);
    read_keys<RoutePoint>(scene, its, {kRouteRows}, "", point);
    its.demand("latitude_deg", "a latitude");
    its.demand("longitude_deg", "a longitude");
    its.finish();
    speed_m_s = point.speed_m_s;
    config.route.points.push_back(point);
  });
}

TargetConfig read_target(SceneReading& scene, const ConfigNode& table) {
  TargetConfig config;
  SectionReader reader(table, "target", scene.complaints);
  read_name(reader, "target.name", config.name);
  read_type(scene, reader, config);
  read_keys<Target>(scene, reader, {kRows}, "", config.target);
  if (table.find("rcs_dbsm") != nullptr) config.target.size.aspects = nullptr;
  read_route(scene, reader, config);
  reader.demand("name", "a name that no other target has");
  reader.demand("latitude_deg", "a latitude");
  reader.demand("longitude_deg", "a longitude");
  if (config.target.height_reference == HeightReference::ellipsoid)
    reader.demand("geoid_undulation_m", "the geoid's height above the ellipsoid there, m");
  reader.finish();
  for (const FieldError& error : validate(config))
    if (error.field == "route")
      scene.complaints.add(table.where, {"target.route", error.found, error.allowed});
  return config;
}

}  // namespace

bool is_from_aspects(const Key& key, const Target& target) {
  return target.size.aspects && key.name == "rcs_dbsm";
}

void read_targets(SceneReading& scene) {
  std::set<std::string> names;
  scene.top.each_table("target", [&](const ConfigNode& table) {
    std::vector<TargetConfig>& all = scene.config.targets;
    if (all.size() == kMost) {
      scene.complaints.add(table.where, {"target", "one more than " + std::to_string(kMost),
                                         std::to_string(kMost) + " tables [[target]] at most"});
      return;
    }
    if (all.size() > kMost) return;
    all.push_back(read_target(scene, table));
    all.back().target.id = all.size();
    if (const std::string& name = all.back().name; !name.empty() && !names.insert(name).second)
      scene.complaints.add(
          table.where, {"target.name", "a second " + toml_string(name), "another name for each [[target]]"});
  });
}

namespace {

std::vector<Row<Target>> rows_to_print(const Target& target) {
  std::vector<Row<Target>> rows(kRows.begin(), kRows.end());
  std::erase_if(rows, [&](const Row<Target>& row) { return is_from_aspects(row.key, target); });
  return rows;
}

}  // namespace

std::string printed_targets(const SceneConfig& config) {
  std::string text;
  for (const TargetType& type : config.target_types)
    text += "\n[target_types." + toml_key(type.name) + "]\n" +
            printed_keys<TargetType>(target_type_keys(), "", type, config);
  for (const TargetConfig& target : config.targets) {
    text += "\n[[target]]\nname = " + toml_string(target.name) + "\ntype = " + toml_string(target.type) +
            "\n" + printed_keys<Target>({rows_to_print(target.target)}, "", target.target, config) +
            printed_keys<TargetConfig>({kConfigRows}, "", target, config);
    for (const RoutePoint& point : target.route.points) {
      text += "\n[[target.route]]\n";
      RoutePoint printed = point;
      printed.height_m = point.height_m.value_or(target.target.height_m);
      text += printed_keys<RoutePoint>({kRouteRows}, "", printed, config);
    }
  }
  return text;
}

TargetsPtr targets_of(const SceneConfig& config) {
  if (config.targets.empty()) return nullptr;
  auto set = std::make_shared<TargetSet>();
  set->seed = config.target_seed;
  for (TargetConfig target : config.targets) {
    target.lay_route();
    set->targets.push_back(std::move(target.target));
  }
  return set;
}

}  // namespace obliq
