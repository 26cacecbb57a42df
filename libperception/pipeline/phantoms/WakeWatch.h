#pragma once
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "libperception/filter/state/Track.h"
#include "libperception/measurement/frames/WakeMap.h"
#include "libperception/pipeline/PipelineSetup.h"

namespace perception {

/// Keeps the wakes of the tracked vehicles, and learns for each lidar how many phantoms are in
/// them, from clusters that are classified by their shape (method.md 5.19). Indices refer to
/// `sensors`; it and `classes` must outlive this.
class WakeWatch {
 public:
  WakeWatch(const std::vector<PipelineSetup::Sensor>& sensors, const ClassTable& classes);

  /// The wakes at an instant; null: none.
  std::shared_ptr<const WakeMap> at(Stamp stamp) const;
  /// [0, 1] P(vehicles throw up spray), by the phantoms that this sensor saw in wakes lately.
  double spray(std::size_t sensor, Stamp stamp) const;
  /// Gives a scan the wakes, if phantoms were seen in wakes lately. `clutter_per_scan`: the rate
  /// that holds in the scan's model.
  void apply(std::size_t sensor, MeasurementScan& scan, double clutter_per_scan) const;
  /// The scan after that; `hypothesis`: the most probable one after it.
  void add(std::size_t sensor, const MeasurementScan& scan, const Hypothesis& hypothesis);
  /// After a clock jump or when all tracks are deleted.
  void restart();

 private:
  struct Seen {
    double phantoms = 0, area = 0;  ///< clusters, [m^2] of wakes; remembered
    Stamp stamp;
  };
  /// A vehicle whose track was lost.
  struct Lost {
    Stamp since;
    VehicleFootprint vehicle;  ///< where it must be now
  };
  void count(const MeasurementScan& scan, Seen& seen) const;
  void addVehicles(Stamp stamp, const Hypothesis& hypothesis);
  void goOn(Stamp stamp);

  const std::vector<PipelineSetup::Sensor>& sensors_;
  const ClassTable& classes_;
  std::vector<Seen> seen_;                                      ///< by sensor
  std::map<std::uint64_t, std::deque<VehicleFootprint>> last_;  ///< by track: its footprints
  std::map<std::uint64_t, Lost> lost_;                          ///< by track
  std::deque<VehicleFootprint> gone_;  ///< the ways that lost vehicles must have gone, by time
  WakeMap wakes_;
};

}  // namespace perception
