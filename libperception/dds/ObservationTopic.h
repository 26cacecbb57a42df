#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libperception/dds/Network.h"

namespace perception {

/// Publishes observations, whole, on the topic perception/observations.
class ObservationPublisher {
 public:
  /// Throws Error (kUnavailable).
  explicit ObservationPublisher(const NetworkName& name);
  /// False when a reader that wants all could not follow for 100 ms: it will miss some.
  bool publish(const mrpt::obs::CObservation& observation);

 private:
  std::shared_ptr<Network> network_;
  int writer_ = 0;
  std::uint64_t id_ = 0, number_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// Receives what ObservationPublishers of any process send.
class ObservationSubscriber {
 public:
  struct Ledger {
    std::uint64_t received = 0;
    std::uint64_t lost = 0;     ///< by the numbers of their publishers
    std::uint64_t damaged = 0;  ///< no observation
  };

  /// Throws Error (kUnavailable).
  explicit ObservationSubscriber(const NetworkName& name);
  /// What came since the last call, in order of arrival.
  std::vector<std::shared_ptr<mrpt::obs::CObservation>> take();
  const Ledger& ledger() const { return ledger_; }

 private:
  std::shared_ptr<mrpt::obs::CObservation> observationOf(const void* message);

  std::shared_ptr<Network> network_;
  int reader_ = 0;
  Ledger ledger_;
  std::map<std::uint64_t, std::uint64_t> next_;  ///< number expected, by publisher
};

}  // namespace perception
