#pragma once
// A client that outlives its connection: what it asked for is asked for again when the server is back.
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "client/client.h"

namespace obliq::client {

struct ResumeOptions {
  std::chrono::seconds patience{300};  ///< how long to try again after a loss; 0: not at all
  Timeout first_pause{100};            ///< between two attempts; doubled each time, up to the longest
  Timeout longest_pause{5000};
  /// Called once per loss, before the first attempt, and once when all is as it was before.
  std::function<void(const Status& why)> on_lost{};
  std::function<void(std::chrono::duration<double> after)> on_resumed{};
  /// Looked at ten times a second while trying; true: the loss is reported at once. May be empty.
  std::function<bool()> give_up{};
};

/// Connects again when the connection is lost, not when the server has refused this client for good. Frames
/// in progress are discarded; frames of the time between are lost. Blocking, for one thread at a time.
class ResumingClient {
 public:
  /// client: has been connected once; its endpoint and options are used again.
  ResumingClient(Client client, ResumeOptions options);

  /// For requests that need not be repeated. One that fails because the connection is lost is the caller's to
  /// repeat: receive() takes the connection up again.
  Client& client() { return client_; }
  const Client& client() const { return client_; }

  /// Makes a request now and, if it succeeds, again on each new connection, in this order. `name`: an earlier
  /// request of that name is replaced in its place.
  Status hold(const std::string& name, std::function<Status(Client&)> request);
  void forget(const std::string& name);
  Status claim_control(const std::string& radar);
  Status claim(const std::string& radar, wire::ClaimSet claims);
  Status subscribe(const std::string& radar, double rate_hz, wire::PlaneSet planes = wire::kAllPlanes);
  Status subscribe(const wire::Subscribe& request);

  /// As Client::receive. Where the connection is lost, or has been, it blocks until all that is held has been
  /// asked for again, and returns ok; or until patience ends, and returns how it was lost.
  Status receive(Timeout timeout);

 private:
  struct Held {
    std::string name;
    std::function<Status(Client&)> request;
  };
  bool is_lost(const Status& status) const;
  Status resume(Status why);
  Status attempt();
  bool wait(Timeout pause, std::chrono::steady_clock::time_point end) const;

  Client client_;
  ResumeOptions options_;
  std::vector<Held> held_;
  Timeout pause_{};
  std::chrono::steady_clock::time_point connected_since_ = std::chrono::steady_clock::now();
};

}  // namespace obliq::client
