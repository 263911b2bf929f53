#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/apps/scene_arguments.h"
#include "server/control/scene_config.h"
#include "server/net/io_thread.h"

namespace obliq {

class SceneKeeper;
namespace security {
class Security;
}
namespace net {
class Server;
}

/// What SIGHUP does. Tokens and certificate are read first and reloaded independently of each other and
/// of the scene, also while a scene is being built. Then the scene file is read: log,
/// limits and radars' parameters change at once, a scene is built by the keeper. A newer signal supersedes
/// what an older one has begun. On the io thread, but for what it starts by itself.
class Reloader {
 public:
  /// `config` is what runs, as read from the arguments' file, before [accuracy] chose its pixels.
  Reloader(net::IoThread& io, std::shared_ptr<security::Security> security, SceneConfig config,
           SceneArguments arguments);
  ~Reloader();  // waits for what reads
  Reloader(const Reloader&) = delete;
  Reloader& operator=(const Reloader&) = delete;

  /// Clients are served from now on: what was asked for before is done now. text: of that for systemd.
  void serve(net::Server& server, SceneKeeper& keeper, std::string text);
  /// A SIGHUP.
  void begin();
  /// As last taken over.
  const SceneConfig& in_file() const { return in_file_; }

 private:
  struct Read {
    std::string fault;
    SceneConfig wanted;
    SceneConfig to_build;  ///< with what [accuracy] chose
  };
  void read_security(int number, net::Server* server);
  void security_was_read(int number, const std::string& taken, const std::vector<std::string>& faults);
  void read_scene(int number, const std::string& taken);
  void take_over(int number, const std::string& taken, Read read);
  void take_over_radars(const SceneConfig& wanted, const SceneConfig& to_build);
  void build(int number, const std::string& taken, const std::string& signature, SceneConfig config);
  void built(int number, const std::string& fault);
  void rest();

  net::IoThread& io_;
  const std::shared_ptr<security::Security> security_;
  const SceneArguments arguments_;
  const SceneConfig at_start_;  ///< what needs a restart to change is still as it was then
  SceneConfig in_file_;
  std::string signature_;  ///< of the scene that serves
  std::string serving_text_;
  net::Server* server_ = nullptr;  ///< null: no client is served yet
  SceneKeeper* keeper_ = nullptr;
  bool wanted_ = false;          ///< a signal came too early
  std::atomic<int> newest_ = 0;  ///< signals so far
  bool reading_ = false;         ///< the newest signal's files
  struct Building {
    int number;
    std::string taken;  ///< "tokens were taken over"
    std::string signature;
  };
  std::optional<Building> building_;

  struct Readers;
  std::unique_ptr<Readers> readers_;  ///< last: they use what is above
};

/// "main, nose"
std::string radar_names(const SceneConfig& config);

/// Keys whose values differ and that only a restart applies: addresses, ports, files of certificate and
/// tokens, which radars there are, threads. What is not named here a running daemon takes over: the radars'
/// parameters, terrain, buildings, materials, earth, accuracy, flight, the log, the limits of [server].
std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted);

/// Everything that a scene is built from, as text: keys, and sizes and times of the files that are local. Two
/// that are equal build the same scene.
std::string scene_signature(const SceneConfig& config);

}  // namespace obliq
