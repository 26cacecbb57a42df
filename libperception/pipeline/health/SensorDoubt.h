#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/models/ClutterMap.h"

namespace perception {

/// Detections of a sensor within the last ten seconds.
struct DetectionCount {
  double expected = 0;  ///< by its tables, of objects that other sensors saw
  double seen = 0;      ///< of these

  /// (0, 1] share of P_D that the sensor has. `before`: what it was worth before any look, as much
  /// as four looks (method.md 4.8).
  double share(double before) const;
};

/// Evidence that a sensor other than a lidar is faulty: it misses objects that other sensors see in
/// its view and that it should see by its tables or saw until now; its usual false measurements
/// stay away; its bearings all err to the same side (method.md 9.10).
class SensorDoubt {
 public:
  /// A scan and the tracks after it; `seen_share`: what weather has left of P_D in its model.
  void add(const MeasurementScan& scan, const Hypothesis& tracks, const FilterModel& model,
           double seen_share);
  /// An object that the sensor should have seen in a scan by its tables, with probability
  /// `detection`.
  void addLook(double detection, bool seen);
  /// An object that it did not see in a scan, and would have seen with that probability.
  void addMiss(double detection);
  /// Bearing of a detection minus that of its object as others see it, [rad].
  void addBearing(Stamp stamp, std::uint64_t object, double error);
  /// A scan with something in it, and what was known of the sensor's clutter then.
  void hear(std::shared_ptr<const ClutterMap> clutter) {
    silent_ = 0, log_missed_ = 0, usual_ = std::move(clutter);
  }
  /// A scan with nothing in it.
  void passSilence(const std::shared_ptr<const ClutterMap>& clutter) {
    ++silent_;
    if (!usual_) usual_ = clutter;
  }

  /// Log probability that a healthy sensor has been silent since its last measurement. It is the
  /// log-likelihood ratio against a blind sensor, whose silence is certain.
  double logSilence() const;
  const DetectionCount& count() const { return count_; }
  /// Log-likelihood ratio that the sensor misses more than half of what it should see, since the
  /// instant at which this is most likely.
  double fouled() const { return fouled_; }
  /// [rad] mean error of the bearings of the last seconds if it is larger than chance explains;
  /// else empty.
  std::optional<double> offset(Stamp now) const;

 private:
  struct Bearing {
    Stamp stamp;
    std::uint64_t object;
    double error;
  };
  /// What became of one object in this sensor's scans.
  struct Looks {
    double expected = 0, hits = 0;  ///< remembered; expected by the tables
    Stamp last;
  };
  /// Looks of before are remembered as of now; objects out of memory are dropped.
  void forget(Stamp now);

  std::map<std::uint64_t, Looks> looks_;  ///< by track
  double log_missed_ = 0, fouled_ = 0;
  DetectionCount count_;
  std::optional<Stamp> last_;                ///< scan
  std::size_t silent_ = 0;                   ///< scans in a row
  std::shared_ptr<const ClutterMap> usual_;  ///< before the silence
  std::deque<Bearing> bearings_;
};

}  // namespace perception
