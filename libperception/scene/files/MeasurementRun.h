#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

/// One sensor of a run: labels of its front end and expected detection range.
struct RecordedSensor {
  std::string label;
  Modality modality = Modality::kLidar;
  double fov = kTwoPi;                  ///< [rad] full angle about its forward axis
  double range_min = 0, range_max = 0;  ///< [m]
  std::vector<std::string> labels;      ///< of its measurements
  /// [m] by class: range at which P_D falls to half of its value near the sensor, at most
  /// range_max.
  std::vector<double> class_range;
};

/// One measurement of the filter's input, reduced to its position.
struct RecordedMeasurement {
  std::string label;
  Vector2 position = Vector2::Zero();  ///< [m] approximate position, world
  double range = 0;                    ///< [m] from the sensor
  double bearing = 0;                  ///< [rad] off the sensor's forward axis
  double sd_range = 0;                 ///< [m] along the line of sight
  double sd_across = 0;                ///< [m] across it
  double score = 0;                    ///< log p(score | object) / p(score | clutter)
  double length = std::numeric_limits<double>::quiet_NaN(), width = length,
         height = length;  ///< [m] NaN: not measured
};

/// All measurements of one sensor at one instant; may be empty.
struct RecordedScan {
  std::size_t sensor = 0;  ///< in MeasurementRun::sensors
  std::int64_t frame = -1;
  Stamp stamp;
  Pose3 T_world_ego = Pose3::Identity();
  Pose3 T_world_sensor = Pose3::Identity();
  std::size_t dropped = 0;  ///< detections without a measurement
  std::vector<RecordedMeasurement> measurements;
};

/// All measurements of a run.
struct MeasurementRun {
  std::string dir;
  Stamp first_stamp;  ///< of the log: t = 0
  std::vector<std::string> class_names;
  std::vector<RecordedSensor> sensors;
  std::vector<RecordedScan> scans;  ///< in order of time
};

/// Describes a scan's sensor; class_range by evaluating the model's P_D along the sensor's axis.
/// `labels`: of the front end; field of view as in [sensor.LABEL].
RecordedSensor describeSensor(const MeasurementScan& scan, std::vector<std::string> labels,
                              double fov, double range_min, double range_max, int classes);

/// The record of a scan.
RecordedScan recordScan(const MeasurementScan& scan, const RecordedSensor& sensor);

/// Writes sensors.csv (one line per sensor and class), scans.csv (per scan) and measurements.csv
/// (per measurement). World frame, SI units, fixed number format; labels are joined by '|'.
///
/// sensors.csv: sensor,modality,fov,range_min,range_max,labels,class,class_range
/// scans.csv: sensor,frame,t,stamp,ego_x,ego_y,ego_z,ego_yaw,x,y,z,yaw,dropped,measurements
/// measurements.csv: sensor,frame,t,stamp,label,x,y,range,bearing,sd_range,sd_across,score,
///                   length,width,height
class MeasurementRunWriter {
 public:
  /// Creates the files in DIR, which must exist. Throws OutputError.
  MeasurementRunWriter(const std::string& dir, const ClassTable& classes);
  void writeSensor(const RecordedSensor& sensor);
  /// Scans in chronological order; `first_stamp` of the log.
  void write(const RecordedScan& scan, const RecordedSensor& sensor, Stamp first_stamp);
  /// Flushes and checks that everything was written. Throws OutputError with kIoError.
  void close();

 private:
  OutputFile sensors_, scans_, measurements_;
  ClassTable classes_;
};

/// Throws DataError naming file, line and column; kNoInput if the run was tracked without
/// --measurements.
MeasurementRun readMeasurementRun(const std::string& dir);

}  // namespace perception
