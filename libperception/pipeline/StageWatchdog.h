#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "libperception/scene/RunTiming.h"

namespace perception {

/// Looks from a thread of its own whether a run of sensors at work gets on: a stage other than
/// "read", which waits for the sensors, has a time limit.
class StageWatchdog {
 public:
  /// `on_hang` is called once, from the thread, with the name of the stage (RunTiming::current())
  /// that has not ended for `limit` [s].
  StageWatchdog(const RunTiming& timing, double limit,
                std::function<void(const std::string& stage)> on_hang);
  ~StageWatchdog();
  StageWatchdog(const StageWatchdog&) = delete;
  StageWatchdog& operator=(const StageWatchdog&) = delete;

 private:
  void watch();

  const RunTiming& timing_;
  const double limit_;  ///< [s]
  const std::function<void(const std::string&)> on_hang_;
  std::mutex mutex_;
  std::condition_variable ended_changed_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace perception
