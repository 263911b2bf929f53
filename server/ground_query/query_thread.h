#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <thread>

namespace obliq {

/// One thread for all ground queries, begun with the first, so that they hold up neither sockets nor frames,
/// and take no more of the machine than one core. Clients take turns, query by query.
class QueryThread {
 public:
  using Work = std::function<void(const std::stop_token&)>;

  QueryThread() = default;
  ~QueryThread();  // end()s

  /// From any thread. `work` must not throw.
  void enqueue(std::uint64_t client, Work work);
  /// Stops the current query, drops what waits, and waits for the thread. Nothing is begun any more.
  void end();
  /// A client has gone: what waits for it is dropped, the current query is stopped.
  void forget(std::uint64_t client);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;  ///< guards all but the thread
  std::condition_variable_any changed_;
  std::map<std::uint64_t, std::deque<Work>> waiting_;  ///< by client; none is empty
  std::uint64_t last_client_ = 0;                      ///< of the current or last query
  bool busy_ = false;
  bool ended_ = false;
  std::stop_source in_hand_;
  std::jthread thread_;
};

}  // namespace obliq
