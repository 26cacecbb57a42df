#pragma once
#include <string>
#include <vector>

#include "libperception/pipeline/input/RecordedLog.h"

namespace perception {

/// Tempering exponents of the class update: eta of method.md 5.6.
struct Exponents {
  struct OfSensor {
    std::string sensor;  ///< label
    double label = 1, detection = 1;
  };
  std::vector<OfSensor> sensors;
  double kinematic = 1;  ///< [filter] kinematic_exponent
};

/// The log with other exponents; scans are shared except for their models.
RecordedLog withExponents(const RecordedLog& log, const Exponents& exponents);
/// The exponents that the log was recorded with; sensors sorted by label.
Exponents exponentsOf(const RecordedLog& log);

}  // namespace perception
