#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/vision/BoxGeometry.h"

namespace perception {

/// [sensor.LABEL.detector]: the detector's class names, scores and heading errors.
struct DetectorParams {
  std::vector<std::string> labels{"car",
                                  "person"};  ///< of the measurements: columns of the class tables
  /// The detector's class name = one of the labels; other names are dropped and counted.
  std::vector<std::string> names{
      "Car=car",   "Van=car",           "Truck=car",      "car=car",       "bus=car",
      "truck=car", "Pedestrian=person", "Cyclist=person", "person=person", "bicycle=person"};
  double min_score = -1e9;  ///< boxes below are dropped; assumed: the detector has cut
  /// log p(score | object) / p(score | clutter) = slope (score - offset), clamped (method.md 8.8).
  double score_offset = 0;
  double score_slope = 0;  ///< [1/score]; 0: scores are no evidence
  std::vector<std::pair<std::string, double>> label_offsets;  ///< score_offset of single labels
  /// Share of that logarithm that is evidence of the class: all for road users that the label
  /// names, half for other ones, none for things, as clutter; false: the same for all classes.
  bool score_by_class = false;
  /// How errors of one object repeat (method.md 5.6): with its time, whatever the change of view;
  /// `lasting` 0: they do not.
  EvidenceMemory memory{0, 0.5, 0.2, 0.3, 1, 0.5};
  double score_limit = 4;  ///< of that logarithm; assumed
  /// [m] height of the objects of a label, mean and spread: a second source of range (method.md
  /// (15)).
  std::vector<std::pair<std::string, double>> height_priors, height_prior_sigmas;
  /// Boxes also hold what a nearer object hides. Detectors that have learned from boxes about
  /// visible parts (COCO) end there, and such an edge says nothing of the object's.
  bool amodal = false;
  bool base = false;  ///< the lower edge also measures the base height of the object
  /// Least score of a box that occludes objects behind it (see the filter's occluded_detection and
  /// occlusion_tolerance). Assumed: none, until scores were counted.
  double occluder_score = 1e9;
  double heading_sigma = radians(8);    ///< [rad] of the axis: 16 bins of 22.5 deg and an error:
                                        ///< method.md 7. KITTI's bank: 6.7 deg
  double heading_flip = 0.2;            ///< share of reversed headings, assumed; 0.5: axis only
  double heading_flip_persistence = 0;  ///< P(reversed | the previous one was)

  void visit(ParamVisitor& v);
};

/// The camera front end for image boxes of any detector: bearings of the edges, range on the
/// ground, height, label.
class VisionFrontEnd final : public FrontEnd {
 public:
  VisionFrontEnd(DetectorParams detector, BoxGeometryParams geometry, const ClassTable& classes,
                 const DetectionModel& detection_model);

  std::vector<std::string> labelNames() const override {
    return model_->detection_model().labels();
  }

 protected:
  Modality modality() const override { return model_->detection_model().params().modality; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  /// The camera's level frame.
  Pose3 measuringPose(const SensorFrame& frame) const override;
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  std::optional<Measurement> measure(const ObjectDetection& object, const SensorFrame& frame,
                                     const CameraModel& camera, const Pose3& T_ego_camera,
                                     const SensorState& state, const HiddenEdges& hidden) const;

  /// Of the score, between its limits.
  double logScoreRatio(double score, int label) const;
  /// Boxes that are no less likely an object than clutter.
  std::vector<ObjectDetection::ImageBox> probableBoxes(
      const std::vector<ObjectDetection>& objects) const;
  /// Label and score as evidence of the class (method.md 8.8).
  void addClassEvidence(Measurement& m) const;
  std::shared_ptr<const OcclusionMap> occlusion(const MeasurementScan& scan,
                                                const std::vector<ObjectDetection>& objects) const;

  DetectorParams detector_;
  BoxGeometryParams geometry_;
  ClassTable classes_;
  std::map<std::string, int> label_of_;
  std::vector<std::optional<ScalarEstimate>> height_prior_;  ///< by label
  std::shared_ptr<const FootprintModel> model_;
};

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME], [sensor.LABEL.detector] and
/// [sensor.LABEL.geometry].
std::unique_ptr<FrontEnd> makeVisionFrontEnd(Config& config, const std::string& sensor_label,
                                             const ClassTable& classes);

}  // namespace perception
