#include "client/resuming_client.h"

#include <algorithm>
#include <cstdio>
#include <thread>
#include <utility>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

using Clock = std::chrono::steady_clock;
using wire::ErrorNumber;

namespace {

// A connection that held for so long was sound: the next loss begins with the first pause again.
constexpr std::chrono::seconds kSound{10};
constexpr Timeout kLook{100};

/// Refusals that end with time: a server that is going down or full, control that a connection still holds
/// of which the server does not know yet that it is gone.
bool is_passing(std::uint32_t number) {
  switch (static_cast<ErrorNumber>(number)) {
    case ErrorNumber::server_stopping:
    case ErrorNumber::too_many_clients:
    case ErrorNumber::too_many_from_address:
    case ErrorNumber::controlled_by_other:
    case ErrorNumber::too_many_subscriptions:
    case ErrorNumber::over_limit:
      return true;
    default:
      return false;
  }
}

/// Whether another attempt may go better.
bool may_go_better(const Status& status) {
  switch (status.outcome) {
    case Outcome::cannot_connect:
    case Outcome::timed_out:
    case Outcome::closed:
      return true;
    case Outcome::refused:
      return is_passing(status.number);
    default:
      return false;
  }
}

}  // namespace

ResumingClient::ResumingClient(Client client, ResumeOptions options)
    : client_(std::move(client)), options_(std::move(options)), pause_(options_.first_pause) {}

Status ResumingClient::hold(const std::string& name, std::function<Status(Client&)> request) {
  Status status = request(client_);
  if (!status.ok()) return status;
  const auto found = std::ranges::find(held_, name, &Held::name);
  if (found != held_.end()) {
    found->request = std::move(request);
  } else {
    held_.push_back({name, std::move(request)});
  }
  return status;
}

void ResumingClient::forget(const std::string& name) {
  std::erase_if(held_, [&](const Held& held) { return held.name == name; });
}

Status ResumingClient::claim_control(const std::string& radar) {
  return hold("control of " + radar, [radar](Client& client) { return client.claim_control(radar); });
}

Status ResumingClient::claim(const std::string& radar, wire::ClaimSet claims) {
  return hold(wire::claim_names(claims) + " of " + radar,
              [radar, claims](Client& client) { return client.claim(radar, claims); });
}

Status ResumingClient::subscribe(const wire::Subscribe& request) {
  return hold("frames of " + request.radar(), [request](Client& client) {
    wire::Subscribe again = request;
    return client.subscribe(again);
  });
}

Status ResumingClient::subscribe(const std::string& radar, double rate_hz, wire::PlaneSet planes) {
  return hold("frames of " + radar,
              [radar, rate_hz, planes](Client& client) { return client.subscribe(radar, rate_hz, planes); });
}

Status ResumingClient::receive(Timeout timeout) {
  if (!client_.is_open()) return resume(Status::failure(Outcome::closed, "the connection has been lost"));
  Status status = client_.receive(timeout);
  return is_lost(status) ? resume(std::move(status)) : status;
}

bool ResumingClient::is_lost(const Status& status) const {
  if (status.outcome == Outcome::closed) return true;
  if (status.outcome == Outcome::timed_out) return !client_.is_open();  // in the middle of a message
  return status.outcome == Outcome::refused &&
         status.number == static_cast<std::uint32_t>(ErrorNumber::server_stopping);
}

Status ResumingClient::attempt() {
  Status status = client_.reconnect();
  for (auto held = held_.begin(); status.ok() && held != held_.end(); ++held) status = held->request(client_);
  if (!status.ok()) client_.close();
  return status;
}

// False when there is no time left, or no wish.
bool ResumingClient::wait(Timeout pause, Clock::time_point end) const {
  const auto until = std::min(Clock::now() + pause, end);
  for (auto now = Clock::now(); now < until; now = Clock::now()) {
    if (options_.give_up && options_.give_up()) return false;
    std::this_thread::sleep_for(std::min<Clock::duration>(kLook, until - now));
  }
  return Clock::now() < end;
}

Status ResumingClient::resume(Status why) {
  client_.close();
  if (options_.patience.count() <= 0) return why;
  const auto lost_at = Clock::now();
  if (lost_at - connected_since_ >= kSound) pause_ = options_.first_pause;
  if (options_.on_lost) options_.on_lost(why);
  const auto end = lost_at + options_.patience;
  while (wait(pause_, end)) {
    pause_ = std::min(2 * pause_, options_.longest_pause);
    Status status = attempt();
    if (status.ok()) {
      connected_since_ = Clock::now();
      if (options_.on_resumed) options_.on_resumed(connected_since_ - lost_at);
      return status;
    }
    if (!may_go_better(status)) return status;
    why = std::move(status);
  }
  char tried[64];
  std::snprintf(tried, sizeof tried, " (tried again for %.0f s)",
                std::chrono::duration<double>(Clock::now() - lost_at).count());
  why.text += tried;
  return why;
}

}  // namespace obliq::client
