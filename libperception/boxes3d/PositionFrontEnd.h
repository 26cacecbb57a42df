#pragma once
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libperception/boxes3d/ConfidenceLearner.h"
#include "libperception/boxes3d/PositionParams.h"
#include "libperception/boxes3d/ScoreOdds.h"
#include "libperception/config/Config.h"
#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/measurement/models/DetectionModel.h"
#include "libperception/measurement/models/PositionModel.h"

namespace perception {

/// 3D boxes as measurements of their centers: 3D detectors, GPS receivers on objects, sensors that
/// report points. Boxes are in the sensor frame.
class PositionFrontEnd final : public FrontEnd {
 public:
  PositionFrontEnd(PositionParams params, const ClassTable& classes,
                   const DetectionModel& detection_model);

  std::vector<std::string> labelNames() const override { return params_.labels; }
  std::unique_ptr<FramePreparation> preparation() const override;

 protected:
  Modality modality() const override { return modality_; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  /// Parameters of one label.
  struct Label {
    ScoreOdds odds;
    double balance = 0;
    double length_excess = 0, width_excess = 0, height_excess = 0;
    /// By class: log p(label | class); weight of the score's evidence.
    std::vector<double> log_label, score_share;
    double log_clutter = 0;
  };
  struct Candidate {
    const ObjectDetection* object;
    std::size_t index;
    int label;
    double log_odds = 0;  ///< that it is an object, by score and range
  };

  std::vector<std::vector<Candidate>> groups(const ObjectDetections& detections,
                                             MeasurementScan& scan) const;
  Measurement measure(const std::vector<Candidate>& group, const SensorFrame& frame,
                      const SensorState& state) const;
  void addEvidence(const Candidate& c, Measurement& m) const;
  void addBox(const Candidate& c, const SensorFrame& frame, const SensorState& state,
              Measurement& m) const;
  double clutterProbability(const Candidate& c) const;
  double logScoreRatio(const Candidate& c) const;

  PositionParams params_;
  DetectionParams view_;
  Modality modality_;
  std::map<std::string, int> label_of_;
  std::vector<Label> labels_;
  std::shared_ptr<const PositionModel> model_;
};

/// Of confidence = learnt for such a sensor.
ConfidenceLearner::Params learnerParams(const PositionParams& positions,
                                        const DetectionParams& view);

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME] and [sensor.LABEL.positions].
std::unique_ptr<FrontEnd> makePositionFrontEnd(Config& config, const std::string& sensor_label,
                                               const ClassTable& classes);

}  // namespace perception
