#include "libperception/pipeline/watches/StageWatchdog.h"

#include <chrono>
#include <utility>

namespace perception {

StageWatchdog::StageWatchdog(const RunTiming& timing, double limit,
                             std::function<void(const std::string&)> on_hang)
    : timing_(timing), limit_(limit), on_hang_(std::move(on_hang)), thread_([this] { watch(); }) {}

StageWatchdog::~StageWatchdog() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  ended_changed_.notify_all();
  thread_.join();
}

void StageWatchdog::watch() {
  using std::chrono::steady_clock;
  const std::chrono::duration<double> look(limit_ / 10);
  std::uint64_t seen = timing_.changes();
  auto since = steady_clock::now();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ended_changed_.wait_for(lock, look, [this] { return ended_; })) {
    const std::uint64_t now = timing_.changes();
    const std::string stage = timing_.current();
    if (now != seen || stage == "read") {
      seen = now;
      since = steady_clock::now();
    } else if (std::chrono::duration<double>(steady_clock::now() - since).count() > limit_) {
      on_hang_(stage);
      return;
    }
  }
}

}  // namespace perception
