#pragma once
#include <mrpt/obs/CObservation.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception::python {

/// "lidar", "boxes", "radar" or "image".
std::string kindOf(const SensorFrame& frame);
/// The data of a frame as Observation.data has them.
pybind11::dict arraysOf(const SensorFrame& frame);

/// An observation of a log; decoded when its arrays are asked for first.
class LogObservation {
 public:
  explicit LogObservation(std::shared_ptr<mrpt::obs::CObservation> observation)
      : observation_(std::move(observation)) {}

  const mrpt::obs::CObservation& get() const { return *observation_; }
  /// "lidar", "boxes", "radar", "image", "pose", "frame" or "other".
  std::string kind() const;
  /// Empty where no front end reads the class, and of an unusable observation.
  const std::optional<SensorFrame>& frame() const;

 private:
  std::shared_ptr<mrpt::obs::CObservation> observation_;
  mutable std::optional<SensorFrame> frame_;
  mutable bool decoded_ = false;
};

/// A rawlog from its begin to its end. A damaged end is an error, after all that is whole.
class LogIterator {
 public:
  explicit LogIterator(const std::string& path) : reader_(path) {}
  /// Throws stop_iteration at the end, DataError at a damaged one. Any thread.
  LogObservation next();

 private:
  std::mutex mutex_;
  RawlogReader reader_;
};

/// Observation and LogReader of the module.
void addObservations(pybind11::module_& module);

}  // namespace perception::python
