#include "server/ground_query/query_thread.h"

#include <utility>

namespace obliq {

QueryThread::~QueryThread() { end(); }

void QueryThread::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    in_hand_.request_stop();
  }
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void QueryThread::enqueue(std::uint64_t client, Work work) {
  const std::lock_guard lock(mutex_);
  if (ended_) return;
  waiting_[client].push_back(std::move(work));
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  changed_.notify_one();
}

void QueryThread::forget(std::uint64_t client) {
  const std::lock_guard lock(mutex_);
  waiting_.erase(client);
  if (busy_ && last_client_ == client) in_hand_.request_stop();
}

void QueryThread::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    // The next client after the one before, round and round.
    auto next = waiting_.upper_bound(last_client_);
    if (next == waiting_.end()) next = waiting_.begin();
    last_client_ = next->first;
    const Work work = std::move(next->second.front());
    next->second.pop_front();
    if (next->second.empty()) waiting_.erase(next);
    in_hand_ = std::stop_source();
    busy_ = true;
    const std::stop_token token = in_hand_.get_token();
    lock.unlock();
    work(token);
    lock.lock();
    busy_ = false;
  }
}

}  // namespace obliq
