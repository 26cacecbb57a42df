#pragma once
#include <string>
#include <vector>

#include "libperception/pipeline/RecordedLog.h"

namespace perception {

/// How far the evidence of each kind counts in the class update: eta of method.md 5.6.
struct Exponents {
  struct OfSensor {
    std::string sensor;  ///< label
    double label = 1, detection = 1;
  };
  std::vector<OfSensor> sensors;
  double kinematic = 1;  ///< [filter] kinematic_exponent
};

/// The log as it would be with other exponents; scans are shared but for their model's exponents.
RecordedLog withExponents(const RecordedLog& log, const Exponents& exponents);
/// Those that the log was recorded with; sensors in order of their label.
Exponents exponentsOf(const RecordedLog& log);

}  // namespace perception
