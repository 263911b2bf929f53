// What a client asks about the targets of the world.
#include <algorithm>
#include <string>
#include <utility>

#include "client/client.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
// After the messages:
#include "client/client_state.h"

namespace obliq::client {

using wire::MessageType;

namespace {

/// Of the targets in one message, well below what a server takes.
constexpr std::size_t kPageBytes = wire::kMaxDescriptorBytes / 2;
/// So that a page which it ends is below that too. A route of 1,000 points is half of it.
constexpr std::size_t kMostTargetBytes = kPageBytes / 2;
/// Of an item in its list: the number of its field, its length.
constexpr std::size_t kItemBytes = 4;

}  // namespace

Status Client::claim_targets(bool force) {
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  return claim("", wire::kTargetsClaim, force);
}

Status Client::release_targets() {
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  return release("", wire::kTargetsClaim);
}

Status Client::set_targets(const wire::SetTargets& change, std::vector<std::string>& warnings) {
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  warnings.clear();
  // Before anything is sent: a change that does not end would be the beginning of the next.
  for (int k = 0; k < change.targets_size(); ++k)
    if (const std::size_t bytes = change.targets(k).ByteSizeLong(); bytes > kMostTargetBytes)
      return Status::failure(Outcome::bad_argument, "targets[" + std::to_string(k) + "]: found " +
                                                        std::to_string(bytes) + " bytes; allowed: at most " +
                                                        std::to_string(kMostTargetBytes));
  int target = 0, gone = 0;
  bool is_first = true;
  do {
    wire::SetTargets page;
    page.set_clear(change.clear() && std::exchange(is_first, false));
    std::size_t bytes = 0;
    for (; gone < change.gone_size() && bytes < kPageBytes; ++gone, bytes += 10)
      page.add_gone(change.gone(gone));
    for (; target < change.targets_size() && bytes < kPageBytes; ++target) {
      *page.add_targets() = change.targets(target);
      bytes += change.targets(target).ByteSizeLong() + kItemBytes;
    }
    page.set_more(target < change.targets_size() || gone < change.gone_size());
    wire::Ack ack;
    if (Status status = state_->call(MessageType::set_targets, page, MessageType::ack, ack); !status.ok())
      return status;
    warnings.insert(warnings.end(), ack.warnings().begin(), ack.warnings().end());
  } while (target < change.targets_size() || gone < change.gone_size());
  return {};
}

Status Client::get_targets(wire::TargetList& list) {
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  list.Clear();
  for (bool more = true; more;) {
    wire::GetTargets request;
    std::uint64_t last = list.targets_size() > 0 ? list.targets(list.targets_size() - 1).id() : 0;
    request.set_after(last);
    wire::TargetList page;
    if (Status status = state_->call(MessageType::get_targets, request, MessageType::target_list, page);
        !status.ok())
      return status;
    for (const wire::Target& target : page.targets())
      if (target.id() <= std::exchange(last, target.id()))
        return Status::failure(Outcome::bad_stream, "the server's list of targets does not rise by id");
    more = page.more() && page.targets_size() > 0;
    list.MergeFrom(page);
  }
  list.set_more(false);
  return {};
}

}  // namespace obliq::client
