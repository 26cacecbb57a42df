#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "libperception/scene/files/RunTiming.h"

namespace perception {

/// Checks from a thread of its own that a live run makes progress: every stage has a time limit,
/// except "read", which waits for the sensors.
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
