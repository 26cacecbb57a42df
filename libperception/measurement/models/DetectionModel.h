#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Parameters that every sensor has, [sensor.LABEL]. Rates are per scan over the whole field of
/// view.
struct DetectionParams {
  std::string kind = "lidar";  ///< front end by name
  Modality modality = Modality::kLidar;
  double clutter_per_scan = 0.6;  ///< kappa: false measurements (method.md 5.3)
  /// Whether clutter_per_scan stays fixed, or is where learning starts in the run (method.md 5.18).
  enum class Clutter { kFixed, kLearnt } clutter = Clutter::kFixed;
  double births_per_scan = 0.03;  ///< beta: first measurements of new objects (method.md 5.3)
  double range_min = 0, range_max = 70;  ///< [m] of the nearest point of an object [radecki2016]
  double fov = kTwoPi;          ///< [rad] full horizontal angle about the sensor's forward axis
  double label_exponent = 0.3;  ///< (0, 1] tempers labels in the class update (method.md 5.6)
  double detection_exponent =
      0.1;  ///< (0, 1] tempers detections and missed detections there (method.md 5.6)
  /// [-] of the standard deviations of all that its measurements say, where the sensor is worse
  /// than its front end knows (perception-calibrate gains counts it).
  double noise_scale = 1;
  double corner_radius = 0;   ///< [m] by which corners of vehicles' outlines are rounded
  std::optional<Pose3> pose;  ///< in the ego frame; overrides the pose of the log
  std::vector<std::pair<std::string, double>>
      clutter_labels;  ///< P(label | clutter); labels not listed share the rest evenly
  /// Panoramas of [radecki2016]: the row of cameraResolutions(), counted from 1; 0: none. Sets
  /// range_max, clutter, births and the ranges of every class, overriding the INI.
  int resolution = 0;
  /// [radecki2016]'s reading of labels in place of the class tables: a label's precision p is
  /// P(label | its class), 1 - p is P(label | any other class) (method.md 5.6). Empty: the class
  /// tables.
  std::vector<std::pair<std::string, double>> precision;

  void visit(ParamVisitor& v);
  void applyResolution();
};

/// Least P_D of a class in view nearby, if the tables say less (method.md 4.7). With a P_D of zero,
/// a single detection that is clutter, or that belongs to another object, would rule the class out.
inline constexpr double kLeastDetection = 0.001;

/// P_D and labels of one class for one sensor: [sensor.LABEL.class.NAME] overrides
/// [detection.MODALITY.NAME] of classes.ini (method.md 2.3), which overrides these defaults.
struct ClassDetection {
  double detection = 0.9;  ///< P(detected | in view, not occluded, near)
  double full_range =
      1e3;  ///< [m] up to which that holds; from there it falls linearly to 0 at last_range
  double last_range = 1e4;  ///< [m] where P_D is 0; at most the sensor's range_max
  /// [m] standard deviation of each edge of an outline across the line of sight, beyond that of the
  /// measurement: what is detected is not the whole object (method.md 4.1).
  double edge_noise = 0;
  std::vector<std::pair<std::string, double>> labels;  ///< P(label | class, detected), normalized

  void visit(ParamVisitor& v);
};

/// Reads all [detection.MODALITY.CLASS], those of modalities without a sensor too, and reports
/// sections of unknown modalities or classes.
void checkDetectionTables(Config& config, const ClassTable& classes);

/// The tables of one sensor, checked against the class table and the front end's labels.
class DetectionModel {
 public:
  /// `defaults` are those of the front end for [sensor.LABEL].
  static DetectionModel read(Config& config, const std::string& section, const ClassTable& classes,
                             const std::vector<std::string>& labels,
                             const DetectionParams& defaults);
  DetectionModel(DetectionParams params, std::vector<ClassDetection> classes,
                 std::vector<std::string> labels);

  const DetectionParams& params() const { return params_; }
  const ClassDetection& row(ClassId c) const { return classes_[static_cast<std::size_t>(c)]; }
  const std::vector<std::string>& labels() const { return labels_; }
  /// Index of a label name or -1.
  int labelIndex(const std::string& name) const;
  double logLabel(int label, ClassId c) const;
  /// The most probable label of the class.
  int labelOf(ClassId c) const;
  double logLabelClutter(int label) const {
    return log_clutter_labels_[static_cast<std::size_t>(label)];
  }
  /// P_D of a class at a range from the sensor [m] and a bearing off its forward axis [rad].
  double detection(ClassId c, double range, double bearing, double visibility) const;
  double area() const;  ///< [m^2] of the field of view

 private:
  void applyPrecision();
  void applyResolution();

  DetectionParams params_;
  std::vector<ClassDetection> classes_;
  std::vector<std::string> labels_;
  std::vector<std::vector<double>> log_labels_;  ///< [class][label]
  std::vector<double> log_clutter_labels_;
};

}  // namespace perception
