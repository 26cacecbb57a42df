#include "libperception/capture/simulated/DeviceSimulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <utility>

namespace perception {

DeviceSimulator::DeviceSimulator(std::unique_ptr<PacketFeed> feed, std::unique_ptr<PacketSink> sink,
                                 const PacketFaults& faults)
    : feed_(std::move(feed)), sink_(std::move(sink)), faults_(faults), random_(faults.seed) {}

DeviceSimulator::~DeviceSimulator() { stop(); }

void DeviceSimulator::start() {
  thread_ = std::thread([this] { run(); });
}

void DeviceSimulator::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

bool DeviceSimulator::happens(double probability) {
  return static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
}

void DeviceSimulator::send(const std::string& payload) {
  if (sink_->send(payload))
    ++ledger_.sent;
  else if (unsent_++ == 0)
    unsent_why_ = std::strerror(errno);
}

void DeviceSimulator::run() {
  try {
    if (sink_->ready(stop_)) sendAll();
  } catch (const std::exception& error) {
    fault_ = error.what();
  }
  if (unsent_ > 0 && fault_.empty())
    fault_ = fmt::format("{} packets could not be sent: {}", unsent_, unsent_why_);
  ended_ = true;
}

void DeviceSimulator::sendAll() {
  while (auto packet = feed_->next(stop_)) {
    while (!stop_ && std::chrono::steady_clock::now() < packet->due)
      std::this_thread::sleep_until(
          std::min(packet->due, std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
    if (stop_) break;
    sendOne(std::move(packet->payload));
  }
  if (!held_.empty()) send(held_);
  if (unseen_.empty()) return;
  send(unseen_);
  ledger_.missing.pop_back();
  unseen_was_dropped_ ? --ledger_.dropped : ++ledger_.resent;
}

void DeviceSimulator::sendOne(std::string payload) {
  const std::uint64_t number = ledger_.made++;
  const bool whole = number == 0;
  const bool dropped = happens(faults_.loss) && !whole, torn = happens(faults_.torn) && !whole;
  const bool swapped = happens(faults_.swap) && !whole && held_.empty();
  const bool repeated = happens(faults_.repeat) && !whole;
  unseen_.clear();
  if (dropped || torn) {
    ledger_.missing.push_back(number);
    unseen_was_dropped_ = dropped;
    dropped ? ++ledger_.dropped : ++ledger_.torn;
    if (!dropped) send(payload.substr(0, payload.size() / 2));
    unseen_ = std::move(payload);
    return;
  }
  if (swapped) {
    ++ledger_.swapped;
    held_ = std::move(payload);
    return;
  }
  send(payload);
  if (repeated) {
    ++ledger_.repeated;
    send(payload);
  }
  if (!held_.empty()) send(std::exchange(held_, {}));
}

}  // namespace perception
