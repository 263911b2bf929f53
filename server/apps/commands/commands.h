#pragma once
// The sub-commands of `obliq`. Each lives in its own file cmd_NAME.cpp, declares its options on the
// application and sets a callback that does the work. To add one: its file in CMakeLists.txt, its line here,
// its line in the list of obliq.cpp. A command reports an operator's mistake by throwing InputError.

#include <stdexcept>

namespace CLI {
class App;
}

namespace obliq {

/// A command has done what it could, and says what is missing: exit code 2.
class PartlyDone : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void add_render(CLI::App& app);      ///< one frame to files
void add_frontier(CLI::App& app);    ///< time and error of every sampling
void add_frustum(CLI::App& app);     ///< camera values and step sizes
void add_explain(CLI::App& app);     ///< what each ingredient changes and costs
void add_get(CLI::App& app);         ///< one frame from a server to files
void add_watch(CLI::App& app);       ///< frames as they come
void add_record(CLI::App& app);      ///< frames as they come, into a file
void add_replay(CLI::App& app);      ///< that file again
void add_pose(CLI::App& app);        ///< where a live radar stands
void add_fly(CLI::App& app);         ///< along a track
void add_set(CLI::App& app);         ///< the settings of a live radar
void add_exercise(CLI::App& app);    ///< the state of all its radars: save, load, reset, freeze
void add_bookmark(CLI::App& app);    ///< a text at a moment of it, and its log
void add_targets(CLI::App& app);     ///< vehicles, ships and aircraft of its world
void add_status(CLI::App& app);      ///< what a server is doing
void add_query(CLI::App& app);       ///< what is at places of the ground, and whether a radar sees it
void add_cat240(CLI::App& app);      ///< a radar's video for displays
void add_health(CLI::App& app);      ///< whether the daemon of this machine is healthy
void add_parameters(CLI::App& app);  ///< the reference of radar parameters

}  // namespace obliq
