// What a client asks about the targets of the world.
#include <algorithm>
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
      bytes += change.targets(target).ByteSizeLong();
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
    if (list.targets_size() > 0) request.set_after(list.targets(list.targets_size() - 1).id());
    wire::TargetList page;
    if (Status status = state_->call(MessageType::get_targets, request, MessageType::target_list, page);
        !status.ok())
      return status;
    more = page.more() && page.targets_size() > 0;
    list.MergeFrom(page);
  }
  list.set_more(false);
  return {};
}

}  // namespace obliq::client
