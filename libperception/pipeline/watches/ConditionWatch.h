#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/measurement/models/ConditionedModel.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/health/SensorDoubt.h"
#include "libperception/pipeline/phantoms/WeatherWatch.h"

namespace perception {

/// Learns the clutter of every sensor in use from what became of its measurements, and puts the
/// conditions under which a scan was taken into its model. Indices refer to `sensors`, which must
/// outlive this, as must `weather`.
class ConditionWatch {
 public:
  ConditionWatch(const std::vector<PipelineSetup::Sensor>& sensors, const WeatherWatch& weather);

  /// Puts the present conditions into the model of a scan that goes into the filter. `count`: of
  /// this sensor, for cameras while the air is not known to be clear (method.md 4.8). Returns the
  /// share of P_D that was used.
  double apply(std::size_t sensor, MeasurementScan& scan, const DetectionCount& count = {}) const;
  /// The scan after that, processed by the filter as its scan number `index`. Which of its
  /// measurements were clutter is known half a second later: those that belonged to no object and
  /// started none that was seen again (method.md 5.18).
  void add(std::size_t sensor, const MeasurementScan& scan, const CRbpfTracker& tracker,
           std::uint64_t index);
  std::shared_ptr<const ClutterMap> clutter(std::size_t sensor) const {
    return states_[sensor].map;
  }
  /// [1/scan] of false measurements by which its scans are judged: learned or as configured.
  double clutterRate(std::size_t sensor) const;
  /// The learned rates of the whole views, where learned ones hold: INI lines, section by section.
  std::vector<std::string> learned() const;
  /// After a clock jump or when all tracks are deleted: forgets the scans that are not yet judged.
  void restart();

 private:
  /// A scan whose clutter is not known yet.
  struct Open {
    std::uint64_t index;
    Stamp stamp;
    std::vector<double> unclaimed;   ///< by measurement: P(no earlier track is its cause)
    std::vector<std::size_t> cells;  ///< by measurement
  };
  struct State {
    std::shared_ptr<const ClutterMap> map;
    std::deque<Open> open;
    Stamp judged;  ///< stamp of the last judged scan; 0: none
  };
  static void judge(const CRbpfTracker& tracker, State& state);

  const std::vector<PipelineSetup::Sensor>& sensors_;
  const WeatherWatch& weather_;
  std::vector<State> states_;
  /// Whether no lidar tells the weather, but radars could show what the cameras miss.
  bool weather_untold_ = false;
};

}  // namespace perception
