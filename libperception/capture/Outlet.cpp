#include "libperception/capture/Outlet.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace perception {

Outlet::Outlet(Params params) : params_(std::move(params)), thread_([this] { run(); }) {}

Outlet::~Outlet() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Outlet::put(const Drivers::Arrival& arrival) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_) return;
  waiting_.push_back(arrival);
  if (params_.limit > 0 && waiting_.size() > params_.limit) dropOne();
  changed_.notify_all();
}

void Outlet::dropOne() {
  std::map<std::string, std::size_t> waiting;
  for (const auto& arrival : waiting_) ++waiting[arrival.observation->sensorLabel];
  const auto most =
      std::max_element(waiting.begin(), waiting.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  waiting_.erase(std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& arrival) {
    return arrival.observation->sensorLabel == most->first;
  }));
  ++dropped_;
}

void Outlet::run() {
  constexpr auto kTend = std::chrono::seconds(1);
  auto next_tend = std::chrono::steady_clock::now() + kTend;
  std::unique_lock<std::mutex> lock(mutex_);
  try {
    for (;;) {
      changed_.wait_until(lock, next_tend, [&] { return closing_ || !waiting_.empty(); });
      if (waiting_.empty() && closing_) return;
      std::optional<Drivers::Arrival> next;
      if (!waiting_.empty()) {
        next = std::move(waiting_.front());
        waiting_.pop_front();
      }
      const std::uint64_t dropped = dropped_;
      lock.unlock();
      if (next) params_.take(*next, dropped);
      if (params_.tend && std::chrono::steady_clock::now() >= next_tend) params_.tend();
      if (std::chrono::steady_clock::now() >= next_tend)
        next_tend = std::chrono::steady_clock::now() + kTend;
      lock.lock();
    }
  } catch (...) {
    if (!lock.owns_lock()) lock.lock();
    failure_ = std::current_exception();
    waiting_.clear();
  }
}

void Outlet::check() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void Outlet::close() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  check();
}

std::uint64_t Outlet::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

}  // namespace perception
