// `obliq query`: what is at places of the ground, and whether a radar sees points there.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>
#include <string_view>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

struct QueryArguments {
  ServerArguments server;
  std::vector<std::string> at;
  std::vector<std::string> range;
  std::string points;
  bool by_bearing = false;
  std::string antenna;
  bool no_sight = false;
  double undulation_m = 0;
  std::string reference = "datum";
  bool csv = false;
};

constexpr std::size_t kMostPoints = 1'000'000;  ///< of a file: each is kept in memory

/// Two numbers of a place, latitude and longitude or bearing and range, and a height where there is one.
struct GivenPoint {
  double first = 0;
  double second = 0;
  double height_m = 0;
  bool has_height = false;
};

/// "34.1,-118.2" or "34.1,-118.2,250". Throws InputError "WHERE: found ...; allowed: ...".
GivenPoint parse_point(const std::string& text, const std::string& where) {
  const std::vector<std::string> fields = csv_fields(text);
  double numbers[3] = {};
  bool good = fields.size() == 2 || fields.size() == 3;
  for (std::size_t k = 0; good && k < fields.size(); ++k) {
    const auto number = number_in(trimmed(fields[k]));
    good = number.has_value();
    if (good) numbers[k] = *number;
  }
  if (!good)
    throw InputError(
        where + ": found " + printable_text(text, 80) +
        "; allowed: two or three numbers with commas between them, the third a height in metres");
  return {numbers[0], numbers[1], numbers[2], fields.size() == 3};
}

/// One point a line; empty lines and those that begin with # are passed by, and so is a first line that
/// begins with no number. "-": standard input. Throws InputError with FILE:LINE.
std::vector<GivenPoint> read_points(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    refuse_endless_file("--points: " + path, path);
    file.open(path);
    if (!file) throw InputError("--points: " + path + " cannot be read");
  }
  std::istream& lines = path == "-" ? std::cin : file;
  std::vector<GivenPoint> points;
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    if (points.empty() && !number_in(trimmed(csv_fields(line).front()))) continue;
    try {
      points.push_back(parse_point(line, path + ":" + std::to_string(number)));
    } catch (const InputError&) {
      // Before a first point the file may be any, under a wrong name: nothing of it is shown.
      if (!points.empty()) throw;
      throw InputError(path + ":" + std::to_string(number) +
                       ": found no point; allowed: two or three numbers with commas between them");
    }
    if (points.size() > kMostPoints)
      throw InputError("--points: found more than " + std::to_string(kMostPoints) +
                       " points; allowed: that many; split the file");
  }
  if (points.empty()) throw InputError("--points: " + path + ": found no point; allowed: at least one");
  return points;
}

constexpr std::string_view kStates[] = {"known", "unknown", "outside", "too_near"};
constexpr std::string_view kSights[] = {"not_asked",       "visible",         "visible_over_unknown",
                                        "behind_ground",   "behind_building", "below_ground",
                                        "inside_building", "no_height"};

template <std::size_t N, typename Enum>
std::string_view word_of(const std::string_view (&words)[N], Enum value) {
  const auto number = static_cast<std::size_t>(value);
  return number < N ? words[number] : "unknown to this program";
}

std::string material_of(const wire::GroundAnswer& answer, const wire::GroundRecord& record) {
  const int number = record.material;
  return number < answer.materials_size() ? printable_text(answer.materials(number)) : std::to_string(number);
}

void print_csv(const wire::GroundAnswer& answer, const wire::GroundRecord& record) {
  const bool known = record.state == wire::GroundState::known;
  fmt::print("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", record.latitude_deg, record.longitude_deg,
             word_of(kStates, record.state), record.height_m, record.surface_height_m, record.slope_deg,
             record.downhill_deg, known ? csv_field(material_of(answer, record)) : "", record.water ? 1 : 0,
             record.building, record.point_height_m, word_of(kSights, record.sight), record.clearance_deg,
             record.obstacle_range_m);
}

std::string ground_text(const wire::GroundAnswer& answer, const wire::GroundRecord& record) {
  switch (record.state) {
    case wire::GroundState::known:
      break;
    case wire::GroundState::outside:
      return "beyond the loaded terrain";
    case wire::GroundState::too_near:
      return "all ground is farther away";
    default:
      return "no ground is known there";
  }
  std::string text = fmt::format("ground {:.2f} m, slope {:.1f} degrees down to {:.0f}", record.height_m,
                                 record.slope_deg, record.downhill_deg);
  if (record.building != 0)
    text += fmt::format(", building {} with its roof at {:.2f} m", record.building, record.surface_height_m);
  return text + ", " + material_of(answer, record);
}

std::string sight_text(const wire::GroundRecord& record) {
  const std::string point = fmt::format("a point at {:.2f} m", record.point_height_m);
  const std::string way =
      fmt::format("{:.4g} degrees {} what stands highest, at {:.0f} m", std::abs(record.clearance_deg),
                  record.clearance_deg < 0 ? "below" : "above", record.obstacle_range_m);
  switch (record.sight) {
    case wire::Sight::not_asked:
      return {};
    case wire::Sight::visible:
      return "; " + point + " is seen, " + way;
    case wire::Sight::visible_over_unknown:
      return "; nothing known hides " + point + ", " + way + ", but ground on the way is not known";
    case wire::Sight::behind_ground:
      return "; " + point + " is hidden by ground, " + way;
    case wire::Sight::behind_building:
      return "; " + point + " is hidden by a building, " + way;
    case wire::Sight::below_ground:
      return "; " + point + " is under the ground";
    case wire::Sight::inside_building:
      return "; " + point + " is inside the building";
    default:
      return {};
  }
}

void print_text(const wire::GroundAnswer& answer, const wire::GroundRecord& record) {
  fmt::print("{:.7f}, {:.7f}: {}{}\n", record.latitude_deg, record.longitude_deg, ground_text(answer, record),
             sight_text(record));
}

/// The points, and whether they are bearings and ranges.
std::vector<GivenPoint> given_points(const QueryArguments& arguments, bool& by_bearing) {
  const int kinds =
      (arguments.at.empty() ? 0 : 1) + (arguments.range.empty() ? 0 : 1) + (arguments.points.empty() ? 0 : 1);
  if (kinds != 1)
    throw InputError(fmt::format("found {} of --at, --range and --points; allowed: one of them", kinds));
  by_bearing = arguments.by_bearing || !arguments.range.empty();
  if (!arguments.points.empty()) return read_points(arguments.points);
  std::vector<GivenPoint> points;
  for (const std::string& text : arguments.at) points.push_back(parse_point(text, "--at"));
  for (const std::string& text : arguments.range) points.push_back(parse_point(text, "--range"));
  return points;
}

/// All but the points.
wire::QueryGround request_of(const QueryArguments& arguments, const client::Client& client) {
  wire::QueryGround request;
  if (!arguments.antenna.empty()) {
    const GivenPoint antenna = parse_point(arguments.antenna, "--antenna");
    if (!antenna.has_height)
      throw InputError("--antenna: found no height; allowed: LATITUDE,LONGITUDE,HEIGHT");
    request.mutable_antenna()->set_latitude_deg(antenna.first);
    request.mutable_antenna()->set_longitude_deg(antenna.second);
    request.mutable_antenna()->set_height_m(antenna.height_m);
  } else if (!arguments.no_sight) {
    request.set_radar(choose_remote_radar(client, arguments.server));
  }
  request.set_height_reference(arguments.reference == "ground"      ? wire::GROUND
                               : arguments.reference == "ellipsoid" ? wire::ELLIPSOID
                                                                    : wire::DATUM);
  request.set_geoid_undulation_m(arguments.undulation_m);
  return request;
}

void run(const QueryArguments& arguments) {
  bool by_bearing = false;
  const std::vector<GivenPoint> points = given_points(arguments, by_bearing);
  client::Client client = connect_to_server(arguments.server, "obliq query");
  const wire::QueryGround common = request_of(arguments, client);
  if (arguments.csv)
    fmt::print(
        "latitude_deg,longitude_deg,state,height_m,surface_height_m,slope_deg,downhill_deg,material,water,"
        "building,point_height_m,sight,clearance_deg,obstacle_range_m\n");
  const std::size_t most = std::max(1u, client.welcome().limits().max_query_points());
  // A query has heights for all of its points or for none.
  for (std::size_t first = 0, k = 0; first < points.size(); first = k) {
    wire::QueryGround request = common;
    for (; k < std::min(points.size(), first + most) && points[k].has_height == points[first].has_height;
         ++k) {
      const GivenPoint& point = points[k];
      (by_bearing ? request.mutable_bearing_deg() : request.mutable_latitude_deg())->Add(point.first);
      (by_bearing ? request.mutable_range_m() : request.mutable_longitude_deg())->Add(point.second);
      if (point.has_height) request.add_height_m(point.height_m);
    }
    wire::GroundAnswer answer;
    std::vector<wire::GroundRecord> records;
    require(client.query_ground(request, answer, records));
    for (const wire::GroundRecord& record : records) (arguments.csv ? print_csv : print_text)(answer, record);
  }
}

}  // namespace

void add_query(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "query", "Say what is at places of a server's ground, and whether a radar sees points there");
  auto arguments = std::make_shared<QueryArguments>();
  add_server_arguments(*command, arguments->server);
  add_repeatable(*command, "--at", arguments->at,
                 "A place in degrees, and the height in metres of a point there (repeatable)",
                 "LATITUDE,LONGITUDE[,HEIGHT]");
  add_repeatable(
      *command, "--range", arguments->range,
      "True bearing in degrees and slant range in metres from the antenna to the ground (repeatable)",
      "BEARING,RANGE[,HEIGHT]");
  command->add_option("--points", arguments->points, "File of such points, one a line; -: standard input")
      ->type_name("FILE");
  command->add_flag("--by-bearing", arguments->by_bearing, "Lines of --points are bearings and ranges");
  command->add_option("--height-reference", arguments->reference, "What heights of points are counted from")
      ->check(CLI::IsMember({"datum", "ground", "ellipsoid"}))
      ->capture_default_str();
  command
      ->add_option("--undulation", arguments->undulation_m,
                   "Height of the datum above the ellipsoid, with --height-reference ellipsoid")
      ->type_name("M")
      ->check(number_from(-120, 120));
  command
      ->add_option("--antenna", arguments->antenna,
                   "Antenna that looks, in place of a radar's; height above the datum")
      ->type_name("LATITUDE,LONGITUDE,HEIGHT");
  command->add_flag("--no-sight", arguments->no_sight, "Only what is there, not whether a radar sees it");
  command->add_flag("--csv", arguments->csv, "Print a table of comma-separated values");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
