#pragma once
#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/obs/CObservation.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// What stands behind "ros2:" of a capture INI's name or of an input: an INI as of
/// perception-import bag, or nothing. Empty: it is another name.
std::optional<std::string> rosIniOf(const std::string& name);

/// A capture INI: a file, or "ros2:INI", which stands for one with the driver CRosSensor alone.
/// Throws DataError (kNoInput).
std::shared_ptr<const mrpt::config::CConfigFileBase> openCaptureIni(const std::string& name);

/// The sensors of an INI of MRPT's rawlog-grabber: every section with a `driver` is one. Each is
/// asked in a thread of its own, so that a driver that hangs or fails does not disturb the others.
class Drivers {
 public:
  /// An observation as it came.
  struct Arrival {
    std::shared_ptr<mrpt::obs::CObservation> observation;
    std::size_t driver = 0;  ///< index
    std::chrono::steady_clock::time_point at;
  };

  /// Creates and starts the drivers. Throws ConfigError, DataError, Error.
  explicit Drivers(const std::string& ini);
  ~Drivers();
  Drivers(const Drivers&) = delete;
  Drivers& operator=(const Drivers&) = delete;

  std::size_t size() const { return drivers_.size(); }
  const mrpt::hwdrivers::CGenericSensor& operator[](std::size_t i) const { return *drivers_[i]; }
  /// [sensorLabel] of the section.
  std::string label(std::size_t i) const { return drivers_[i]->getSensorLabel(); }

  /// Observations since the last call, in order of arrival; waits up to `wait` for the first one.
  std::vector<Arrival> take(std::chrono::milliseconds wait);
  /// Ends the drivers. Data that are under way are received first, and a last take() returns them.
  /// A driver that does not return within two seconds is left alone.
  void end();
  /// Whether the driver's thread has ended. Only then may its ledger be read.
  bool isOver(std::size_t i) const;
  /// Drivers that failed or did not return, a line each.
  std::vector<std::string> faults() const;

 private:
  struct Shared;
  static void ask(const mrpt::hwdrivers::CGenericSensor::Ptr& driver, std::size_t index,
                  const std::shared_ptr<Shared>& shared);

  std::vector<mrpt::hwdrivers::CGenericSensor::Ptr> drivers_;
  std::shared_ptr<Shared> shared_;  ///< outlives a driver that hangs
  bool ended_ = false;
};

}  // namespace perception
