#pragma once
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"

namespace perception {

/// A front end: turns one sensor's frame into measurements. Const and without state, so front ends
/// may run in parallel.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// `frame.data` must hold the kind of data that this front end reads; bad points and boxes are
  /// dropped and counted.
  virtual MeasurementScan extract(const SensorFrame& frame) const = 0;
  /// Names of what Measurement::label indexes; empty: no labels.
  virtual std::vector<std::string> labelNames() const { return {}; }
};

}  // namespace perception
