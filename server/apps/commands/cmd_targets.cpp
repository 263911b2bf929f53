// `obliq targets`: lists the targets of a server's world, sets and removes them.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <memory>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/target_fields.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

struct TargetsArguments {
  ServerArguments server;
  std::vector<std::string> words;
  std::string file;
  std::vector<std::string> remove;
  bool clear = false;
  bool force = false;
  bool json = false;
  bool types = false;
};

void print_types(const wire::TargetList& list) {
  for (const wire::TargetType& type : list.types())
    std::printf("%-24s %6.1f dB m^2, Swerling %d, %g x %g m, %g m high\n", type.name().c_str(),
                type.rcs_dbsm(), type.swerling(), type.length_m(), type.width_m(), type.top_m());
  if (list.types_size() == 0) std::printf("none: the scene has no [target_types.NAME]\n");
}

void print(client::Client& client, const TargetsArguments& arguments) {
  wire::TargetList list;
  require(client.get_targets(list));
  if (arguments.types) return print_types(list);
  if (arguments.json) {
    for (const wire::Target& target : list.targets()) {
      std::string line;
      wire::append_json(target, line);
      std::printf("%s\n", line.c_str());
    }
    return;
  }
  if (list.targets_size() > 0) std::printf("%s", target_table(list).c_str());
  std::printf("%s of at most %u, %s%s\n",
              counted(static_cast<std::uint64_t>(list.targets_size()), "target").c_str(), list.max_targets(),
              list.controller().empty() ? "not claimed" : "held by ", list.controller().c_str());
}

std::uint64_t id_of(const std::string& text) {
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size() || id == 0)
    throw InputError("--remove: found \"" + text + "\"; allowed: ids, whole numbers from 1");
  return id;
}

void run(const TargetsArguments& arguments) {
  wire::SetTargets change;
  std::vector<wire::Target> targets = targets_of_words(arguments.words);
  if (!arguments.file.empty())
    for (wire::Target& target : targets_of_file(arguments.file)) targets.push_back(std::move(target));
  for (wire::Target& target : targets) *change.add_targets() = std::move(target);
  for (const std::string& id : arguments.remove) change.add_gone(id_of(id));
  change.set_clear(arguments.clear);
  client::Client client = connect_to_server(arguments.server, "obliq targets");
  if (change.targets_size() == 0 && change.gone_size() == 0 && !change.clear())
    return print(client, arguments);
  wire::Status before;
  require(client.get_status(before));
  require(client.claim_targets(arguments.force));
  std::vector<std::string> warnings;
  require(client.set_targets(change, warnings));
  for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  wire::Status status;
  require(client.get_status(status));
  std::printf("%d set; %s in the world, %u before\n", change.targets_size(),
              counted(status.targets(), "target").c_str(), before.targets());
}

}  // namespace

void add_targets(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "targets",
      "List the targets of a server's world; set, move and remove them, which needs the role controller");
  auto arguments = std::make_shared<TargetsArguments>();
  add_server_arguments(*command, arguments->server);
  command
      ->add_option(
          "KEY=VALUE", arguments->words,
          "A target to set: id=7 first, then what is to change, such as type=truck latitude_deg=36.4 "
          "longitude_deg=-107.6 velocity_north_m_s=12 route=36.5,-107.6,12; another id begins another")
      ->type_name("");
  command
      ->add_option("--file", arguments->file,
                   "Set those of a file, a line of JSON each, as --json prints them")
      ->type_name("FILE");
  command->add_option("--remove", arguments->remove, "Remove these")->type_name("ID");
  command->add_flag("--clear", arguments->clear, "Remove all others");
  command->add_flag("--force", arguments->force, "Take the claim from another client; needs the role admin");
  CLI::Option* json = command->add_flag("--json", arguments->json, "List them as JSON, a line each");
  command->add_flag("--types", arguments->types, "List the types that the scene has instead")->excludes(json);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
