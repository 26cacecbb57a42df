#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "libperception/core/Time.h"

namespace perception {

/// A rawlog played in real time, as a driver: what the sensors of `labels` (all, if empty) gave,
/// with stamps moved to the time of playback. Drivers of several processes with the same `start_at`
/// play in step. Keys: README.md of this folder.
class CRawlogSensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(CRawlogSensor)

 public:
  ~CRawlogSensor() override;
  /// Throws DataError for the log.
  void initialize() override;
  void doProcess() override;
  bool ended() const { return ended_; }  ///< all was output

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  void read();
  bool wants(const mrpt::obs::CObservation& observation) const;
  bool put(double due, std::shared_ptr<mrpt::obs::CObservation> observation);

  struct Waiting {
    double due = 0;  ///< [s] since 1970
    std::shared_ptr<mrpt::obs::CObservation> observation;
  };

  std::string log_;
  std::set<std::string> labels_;
  double speed_ = 1, start_at_ = 0;  ///< [s] since 1970
  bool joins_ = false;               ///< start_at is given: what was before this start is left out
  std::uint64_t repeats_ = 1;
  std::mutex mutex_;  ///< of waiting_
  std::condition_variable taken_;
  std::deque<Waiting> waiting_;
  std::atomic<bool> stop_{false}, read_all_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace perception
