#pragma once
// How a command's pictures look.
#include <string>

#include "server/output/ground_map_png.h"

namespace CLI {
class App;
}

namespace obliq {

struct PictureArguments {
  bool north_up = false;
  std::string db_range;
  bool ortho = false;
};

/// Adds --north-up, --db-range and --ortho. `arguments` must outlive the parsing.
void add_picture_arguments(CLI::App& app, PictureArguments& arguments);

/// `has_heights`: the command knows the ground, as --ortho needs it. Throws InputError.
PictureOptions picture_options(const PictureArguments& arguments, bool has_heights = false);

}  // namespace obliq
