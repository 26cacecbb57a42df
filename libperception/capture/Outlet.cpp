#include "libperception/capture/Outlet.h"

#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "libperception/sensors/observations/CObservationLidarScan.h"

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

std::uint64_t sizeInMemory(const mrpt::obs::CObservation& observation) {
  constexpr std::uint64_t kAny = 1000;
  if (const auto* scan = dynamic_cast<const CObservationLidarScan*>(&observation)) {
    const LidarCloud& c = scan->cloud;
    return kAny +
           4 * (c.x.size() + c.y.size() + c.z.size() + c.intensity.size() + c.time_offset.size() +
                c.pulse_width.size()) +
           2 * c.ring.size() + c.echo.size() + c.label.size();
  }
  if (const auto* scan = dynamic_cast<const mrpt::obs::CObservationVelodyneScan*>(&observation))
    return kAny + scan->scan_packets.size() *
                      sizeof(mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket);
  if (const auto* image = dynamic_cast<const mrpt::obs::CObservationImage*>(&observation))
    return kAny + (image->image.isExternallyStored()
                       ? 0
                       : image->image.getWidth() * image->image.getHeight() *
                             (image->image.isColor() ? 3U : 1U));
  return kAny;
}

namespace {
std::uint64_t countOne(const mrpt::obs::CObservation&) { return 1; }
}  // namespace

void Outlet::put(const Drivers::Arrival& arrival) {
  std::vector<Drivers::Arrival> left_out;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (failure_) return;
    waiting_.push_back(arrival);
    if (params_.most_bytes > 0) waiting_bytes_ += sizeInMemory(*arrival.observation);
    if (params_.limit > 0 && waiting_.size() > params_.limit) left_out.push_back(dropOne(countOne));
    while (params_.most_bytes > 0 && waiting_bytes_ > params_.most_bytes && waiting_.size() > 1)
      left_out.push_back(dropOne(sizeInMemory));
  }
  changed_.notify_all();
  if (!params_.left_out) return;
  for (const auto& one : left_out) params_.left_out(one);
}

Drivers::Arrival Outlet::dropOne(Measure measure) {
  std::map<std::string, std::uint64_t> waiting;
  for (const auto& arrival : waiting_)
    waiting[arrival.observation->sensorLabel] += measure(*arrival.observation);
  const auto most =
      std::max_element(waiting.begin(), waiting.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto oldest = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& arrival) {
    return arrival.observation->sensorLabel == most->first;
  });
  Drivers::Arrival dropped = std::move(*oldest);
  waiting_.erase(oldest);
  if (params_.most_bytes > 0) waiting_bytes_ -= sizeInMemory(*dropped.observation);
  ++dropped_;
  return dropped;
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
        if (params_.most_bytes > 0) waiting_bytes_ -= sizeInMemory(*next->observation);
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
