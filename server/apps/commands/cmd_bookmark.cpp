// `obliq bookmark`: a text at this moment of an exercise, or at the place of a replay, for all stations.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <memory>

#include "proto/bookmark.h"
#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/event_table.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

struct BookmarkArguments {
  ServerArguments server;
  std::string text;
  bool list = false;
  bool events = false;
  bool json = false;
  std::uint64_t go = 0;
};

/// From where the seconds of the list count: a replay's beginning, or the first event.
std::int64_t start_ns(const client::Client& client, const wire::ExerciseEvent& first) {
  const wire::ReplayState* replay = client.replay_state();
  return replay != nullptr ? replay->start_utc_ns() : first.utc_ns();
}

void list(client::Client& client, const BookmarkArguments& arguments) {
  std::uint64_t after = 0;
  std::int64_t zero_ns = 0;
  bool first = true;
  wire::ExerciseEvents page;
  do {
    page.Clear();
    require(client.get_events(after, false, page));
    for (const wire::ExerciseEvent& event : page.events()) {
      after = event.number();
      if (!arguments.events && event.kind() != wire::BOOKMARK_EVENT) continue;
      if (first) zero_ns = start_ns(client, event);
      if (first && !arguments.json) std::printf("%s\n", event_heading().c_str());
      first = false;
      if (arguments.json) {
        std::string line;
        wire::append_json(event, line);
        std::printf("%s\n", line.c_str());
      } else {
        std::printf("%s\n", event_line(event, zero_ns).c_str());
      }
    }
  } while (page.more());
  if (first && !arguments.json) std::printf("none\n");
}

void run(const BookmarkArguments& arguments) {
  const bool lists = arguments.list || arguments.events;
  if (arguments.text.empty() && !lists && arguments.go == 0)
    throw InputError("found no text; allowed: a text, --list, --events or --go NUMBER");
  // Before anything is done.
  if (const auto fault = wire::bookmark_fault(arguments.text); fault && !arguments.text.empty())
    throw InputError("TEXT: found " + fault->found + "; allowed: " + fault->allowed);
  client::Client client = connect_to_server(arguments.server, "obliq bookmark");
  if (!arguments.text.empty()) {
    require(client.add_bookmark(arguments.text));
    std::printf("bookmarked\n");
  }
  if (arguments.go != 0) {
    wire::SetReplay request;
    request.set_seek_bookmark(arguments.go);
    require(client.set_replay(request));
    std::printf("all stations are at number %" PRIu64 "\n", arguments.go);
  }
  if (lists) list(client, arguments);
}

}  // namespace

void add_bookmark(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bookmark",
                         "Mark this moment of an exercise, or the place of a replay, with a text that all "
                         "stations see; needs the "
                         "role controller. Lists bookmarks and the log; takes a replay to one");
  auto arguments = std::make_shared<BookmarkArguments>();
  add_server_arguments(*command, arguments->server);
  CLI::Option* text = command->add_option("TEXT", arguments->text, "At most 1000 bytes of UTF-8");
  CLI::Option* list = command->add_flag("--list", arguments->list, "Print the bookmarks with their numbers");
  CLI::Option* events = command->add_flag("--events", arguments->events,
                                          "Print the whole log that the server has: who changed what, when");
  list->excludes(text);
  events->excludes(text);
  command->add_flag("--json", arguments->json, "Print each as a line of JSON");
  command->add_option("--go", arguments->go, "Take a replay, for all stations, to the event of this number")
      ->type_name("NUMBER")
      ->excludes(text)
      ->check(a_count());
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
