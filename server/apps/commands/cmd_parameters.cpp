// `obliq parameters`: what can be set, in which units and within which limits.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "server/apps/commands/commands.h"
#include "server/control/parameter_reference.h"
#include "server/modbus/register_map.h"

namespace obliq {

void add_parameters(CLI::App& app) {
  CLI::App* command = app.add_subcommand("parameters", "List every parameter with unit, default and limits");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "As the Markdown page server/control/PARAMETERS.md");
  auto modbus = std::make_shared<bool>(false);
  command->add_flag("--modbus", *modbus, "The Modbus registers instead: the page server/modbus/REGISTERS.md")
      ->excludes("--markdown");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Every key with unit, default and limits as a JSON array")
      ->excludes("--markdown", "--modbus");
  auto preset = std::make_shared<std::string>();
  command
      ->add_option("--preset", *preset,
                   "The keys of a whole radar, as radar.preset = \"NAME\" has them, with their sources")
      ->type_name("NAME")
      ->excludes("--markdown", "--modbus", "--json");
  command->callback([markdown, modbus, json, preset] {
    std::cout << (!preset->empty() ? preset_text(*preset)
                  : *json          ? parameters_json()
                  : *modbus        ? modbus::registers_markdown()
                  : *markdown      ? parameters_markdown()
                                   : parameters_text());
  });
}

}  // namespace obliq
