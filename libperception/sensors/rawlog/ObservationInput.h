#pragma once
#include <mrpt/obs/CObservation.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libperception/core/Time.h"

namespace perception {

/// Where the observations of a run come from: a rawlog, or sensors at work.
class ObservationInput {
 public:
  virtual ~ObservationInput() = default;

  /// The next observation; null at the end. Sensors at work are waited for.
  virtual std::shared_ptr<mrpt::obs::CObservation> next() = 0;

  virtual bool isComplete() const = 0;      ///< at the end: nothing is known to be missing
  virtual std::string endName() const = 0;  ///< one word: "clean", "torn", ...
  /// One line about the end, where it is not complete.
  virtual const std::string& endMessage() const = 0;
  virtual bool verifiable() const = 0;  ///< whether isComplete() proves it
  virtual std::uint64_t entries() const = 0;
  virtual std::optional<Stamp> lastStamp() const = 0;
  virtual std::uint64_t bytesRead() const = 0;
  virtual std::uint64_t fileBytes() const = 0;  ///< in all; 0: not known

  /// When the last observation of next() came from its sensor; empty for recorded ones.
  virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return {}; }
  /// Observations that were left out because they came faster than they were taken.
  virtual std::uint64_t dropped() const { return 0; }
};

}  // namespace perception
