#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libperception/capture/ChunkedLog.h"

namespace perception {

/// What one sensor of a capture gave.
struct SensorLedger {
  std::uint64_t written = 0;  ///< observations
  std::uint64_t late = 0;     ///< of these, stamped before the sensor's one before
};

/// Records the sensors of an INI of MRPT's rawlog-grabber into a ChunkedLog: every section with a
/// `driver` is one sensor. Nothing of the tail is lost.
class Grabber {
 public:
  /// Creates and starts the drivers. Throws ConfigError, Error, OutputError.
  Grabber(const std::string& ini, const std::string& folder);

  /// Records until `done` says so, then ends the drivers and closes the log. `tick` is called about
  /// once a second. Throws OutputError (kIoError) when the disk is full: closed chunks are whole.
  void run(const std::function<bool()>& done, const std::function<void()>& tick);

  const std::map<std::string, SensorLedger>& sensors() const { return ledgers_; }
  std::uint64_t bytes() const { return log_.bytes(); }
  std::uint64_t chunks() const { return log_.chunks(); }
  /// Packets of all drivers that count them: faults for the user, one a line.
  std::vector<std::string> warnings() const;

 private:
  void poll();
  void endDrivers();
  void noteLedgers();

  std::vector<mrpt::hwdrivers::CGenericSensor::Ptr> drivers_;
  std::map<std::string, SensorLedger> ledgers_;
  std::map<std::string, mrpt::Clock::time_point> last_;
  ChunkedLog log_;
};

}  // namespace perception
