#pragma once
// The targets of the world, which all radars see: who may set them, what they are, when they go.
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/control/sections/target_config.h"
#include "server/net/claims.h"
#include "server/net/options.h"
#include "terrain/base/errors.h"

namespace obliq::rendering {
class RenderThread;
}

namespace obliq::wire {
class ExerciseState;
class RenderOnce;
class SetTargets;
class Target;
class TargetList;
}  // namespace obliq::wire

namespace obliq::net {

class ExerciseLog;

/// On the io thread. Frames see it by snapshots alone (TargetSet), each of a whole change.
class TargetWorld {
 public:
  /// post: runs a function on the io thread, later.
  using Post = std::function<void(std::function<void()>)>;
  /// The targets of options begin. All of these must outlive this.
  TargetWorld(const ServerOptions& options, rendering::RenderThread& render, ExerciseLog& log, Post post);
  ~TargetWorld();

  Claims& claims() { return claims_; }
  const Claims& claims() const { return claims_; }
  /// A client gets the claim; from another it is taken, who is told.
  void claim(Peer& by);
  /// False: it did not hold it.
  bool release(const Peer& peer, const std::string& why);
  /// A client has left, or its role has become lower.
  void forget(const Peer& peer);
  void check_role(Peer& peer);

  struct Outcome {
    std::vector<FieldError> errors;  ///< why nothing was done
    bool too_many = false;           ///< more than max_targets, as the error says
    std::vector<std::string> warnings;
  };
  /// All of it or nothing. The request may be of several messages (SetTargets.more).
  Outcome set(const wire::SetTargets& request, const std::string& by);

  /// What stands in a RenderOnce: its own targets, and with `live` those of the world. Null: none.
  TargetsPtr of_one_frame(const std::vector<Target>& own, bool live);
  /// Reads those of its own, rising by id.
  std::vector<FieldError> read(const wire::RenderOnce& request, std::vector<Target>& targets) const;

  /// A page of them, behind an id; as many as one message takes.
  void write(std::uint64_t after, wire::TargetList& list) const;
  std::size_t n() const { return all_.size(); }
  std::uint64_t expired() const { return expired_; }
  std::uint64_t late() const { return late_; }
  /// Those whose validity is over go.
  void expire();

  // As an ExercisePart has it:
  void write(wire::ExerciseState& state) const;
  std::vector<FieldError> faults(const wire::ExerciseState& state) const;
  void take(const wire::ExerciseState& state);
  void reset();
  void freeze(bool on);

  /// The server's clock, which stands in a total freeze.
  std::int64_t now_ns() const;

 private:
  using All = std::map<std::uint64_t, TargetConfig>;
  /// What a request makes of the targets that it names.
  struct Change {
    std::set<std::uint64_t> gone;
    All set;
    std::uint64_t late = 0;  ///< left out
  };

  using Messages = std::vector<const wire::Target*>;
  /// Reads a request's targets; `all`: those that it is a change of.
  std::vector<FieldError> read(const Messages& messages, const All& all, Change& change) const;
  /// The same of a world that has none.
  std::vector<FieldError> read_anew(const Messages& messages, Change& change) const;
  /// One target, from what it was to what it is to be; null: it is new.
  std::vector<FieldError> merge(const wire::Target& message, const TargetConfig* was, TargetConfig& is) const;
  /// The times of a target that moves on from now as the message says.
  Target begin_anew(const wire::Target& message, const Target& was, bool is_new) const;
  /// Why so much is more than fits.
  struct Amount {
    std::size_t targets = 0;
    std::size_t gone = 0;
    std::size_t points = 0;  ///< of routes
    std::size_t bytes = 0;
  };
  std::vector<FieldError> oversize(const Amount& amount, const std::string& where) const;
  Outcome commit(const wire::SetTargets& request, const std::string& by);
  std::vector<FieldError> too_much(const wire::SetTargets& request, const Change& change) const;
  wire::Target message_of(const TargetConfig& target) const;
  /// Those of the options, and no others.
  void begin();
  /// The render thread gets a snapshot before long: one of all that has been set meanwhile.
  void changed();
  void publish();

  const ServerOptions& options_;
  rendering::RenderThread& render_;
  ExerciseLog& log_;
  Claims claims_;
  All all_;
  std::uint64_t version_ = 0;
  std::uint64_t expired_ = 0;
  std::uint64_t late_ = 0;
  std::optional<std::int64_t> frozen_since_ns_;
  struct Staged;
  std::unique_ptr<Staged> staged_;  ///< the holder's request so far; null: none
  Post post_;
  bool is_published_ = true;
  TargetsPtr published_;
};

}  // namespace obliq::net
