#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "libperception/capture/drivers/Drivers.h"

namespace perception {

/// [bytes] of an observation, roughly: its points, packets or pixels.
std::uint64_t sizeInMemory(const mrpt::obs::CObservation& observation);

/// Where a capture's observations go, in a thread of its own: a log, a stream. A slow outlet delays
/// neither the sensors nor other outlets.
class Outlet {
 public:
  struct Params {
    /// Largest number of observations that wait. Beyond it, the oldest one of the sensor that has
    /// most waiting is left out. 0: no limit.
    std::size_t limit = 0;
    /// Takes one; `dropped`: left out so far.
    std::function<void(const Drivers::Arrival& arrival, std::uint64_t dropped)> take;
    std::function<void()> tend;  ///< called about once a second; may be empty
    /// The same limit in bytes, as sizeInMemory(), and by bytes of the sensors; 0: none.
    std::uint64_t most_bytes = 0;
    /// Called with each observation that is left out, from the thread that puts; may be empty.
    std::function<void(const Drivers::Arrival& arrival)> left_out;
  };

  explicit Outlet(Params params);
  ~Outlet();
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  void put(const Drivers::Arrival& arrival);
  /// Rethrows the first exception of `take` or `tend`; the outlet is closed afterwards.
  void check();
  /// Returns once all was taken; throws as check().
  void close();
  std::uint64_t dropped() const;

 private:
  void run();
  using Measure = std::uint64_t (*)(const mrpt::obs::CObservation&);
  /// The oldest one of the sensor of which most waits by `measure`.
  Drivers::Arrival dropOne(Measure measure);

  const Params params_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Drivers::Arrival> waiting_;
  std::uint64_t waiting_bytes_ = 0;  ///< where there is a limit
  std::uint64_t dropped_ = 0;
  bool closing_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace perception
