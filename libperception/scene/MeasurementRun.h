#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/ObjectClass.h"
#include "libperception/scene/OutputFile.h"

namespace perception {

/// One sensor of a run: what its front end calls things, and how far it is expected to see them.
struct RecordedSensor {
  std::string label;
  Modality modality = Modality::kLidar;
  double fov = kTwoPi;                  ///< [rad] full angle about its forward axis
  double range_min = 0, range_max = 0;  ///< [m]
  std::vector<std::string> labels;      ///< of its measurements
  /// [m] by class: up to where P_D is at least half of what it is near, range_max at most.
  std::vector<double> class_range;
};

/// One measurement as it was handed to the filter, reduced to its place.
struct RecordedMeasurement {
  std::string label;
  Vector2 position = Vector2::Zero();  ///< [m] rough place, world
  double range = 0;                    ///< [m] from the sensor
  double bearing = 0;                  ///< [rad] off the sensor's forward axis
  double sd_range = 0;                 ///< [m] along the line of sight
  double sd_across = 0;                ///< [m] across it
  double score = 0;                    ///< log p(score | object) / p(score | clutter)
  double length = std::numeric_limits<double>::quiet_NaN(), width = length,
         height = length;  ///< [m] as far as seen; NaN: not seen
};

/// All measurements of one sensor at one instant; none is a scan, too.
struct RecordedScan {
  std::size_t sensor = 0;  ///< in MeasurementRun::sensors
  std::int64_t frame = -1;
  Stamp stamp;
  Pose3 T_world_ego = Pose3::Identity();
  Pose3 T_world_sensor = Pose3::Identity();
  std::size_t dropped = 0;  ///< detections that became no measurement
  std::vector<RecordedMeasurement> measurements;
};

/// Everything that the front ends of a run handed to the filter.
struct MeasurementRun {
  std::string dir;
  Stamp first_stamp;  ///< of the log: t = 0
  std::vector<std::string> class_names;
  std::vector<RecordedSensor> sensors;
  std::vector<RecordedScan> scans;  ///< in order of time
};

/// What a scan's sensor is expected to see: probes the model's P_D along the sensor's axis.
/// `labels` as the front end names them; view as in [sensor.LABEL].
RecordedSensor describeSensor(const MeasurementScan& scan, std::vector<std::string> labels,
                              double fov, double range_min, double range_max, int classes);

/// The scan as it is recorded.
RecordedScan recordScan(const MeasurementScan& scan, const RecordedSensor& sensor);

/// Writes sensors.csv (a line a sensor and class), scans.csv (a line a scan) and measurements.csv
/// (a line a measurement). World frame, SI units, fixed number format; labels are joined by '|'.
///
/// sensors.csv: sensor,modality,fov,range_min,range_max,labels,class,class_range
/// scans.csv: sensor,frame,t,stamp,ego_x,ego_y,ego_z,ego_yaw,x,y,z,yaw,dropped,measurements
/// measurements.csv: sensor,frame,t,stamp,label,x,y,range,bearing,sd_range,sd_across,score,
///                   length,width,height
class MeasurementRunWriter {
 public:
  /// Opens the files in DIR, which must be there. Throws OutputError.
  MeasurementRunWriter(const std::string& dir, const ClassTable& classes);
  void writeSensor(const RecordedSensor& sensor);
  /// Scans in order of time; `first_stamp` of the log.
  void write(const RecordedScan& scan, const RecordedSensor& sensor, Stamp first_stamp);
  /// Flushes and checks that everything was written. Throws OutputError with kIoError.
  void close();

 private:
  OutputFile sensors_, scans_, measurements_;
  ClassTable classes_;
};

/// Throws DataError naming file, line and column; kNoInput where the run recorded no measurements.
MeasurementRun readMeasurementRun(const std::string& dir);

}  // namespace perception
