#pragma once
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libperception/boxes3d/ScoreOdds.h"
#include "libperception/config/Config.h"
#include "libperception/measurement/DetectionModel.h"
#include "libperception/measurement/FrontEnd.h"
#include "libperception/measurement/PositionModel.h"

namespace perception {

/// [sensor.LABEL.positions]: measurements of boxes in space, or points. Tables "key.LABEL" hold for
/// one label; a label without an entry has 0.
struct PositionParams {
  using Table = std::vector<std::pair<std::string, double>>;
  std::vector<std::string> labels{"object"};        ///< the columns of the class tables
  std::vector<std::string> names{"object=object"};  ///< the detector's class = one of the labels
  double min_score = -1e9;                          ///< boxes below are dropped: none (assumed)
  double sigma = 0.3;               ///< [m] of the center, each axis (method.md 8.9, assumed)
  double range_share = 0;           ///< [-] of the distance, added to sigma (method.md 8.9)
  double clutter_sigma_growth = 0;  ///< [-] by which both grow for a box that is surely clutter, by
                                    ///< its score (method.md 8.9)

  /// Score as evidence, method.md (49), counted on recordings with truth: P(object | score, range)
  /// = 1 / (1 + exp(-slope (score - offset) + fade range)), [1/score], [score], [1/m]; slope 0:
  /// scores are no evidence. balance: log of (objects / clutter) in that count; it turns the odds
  /// into p(score | object) / p(score | clutter).
  Table score_slope, score_offset, score_fade, score_balance;
  double score_limit = 6;  ///< bound of that logarithm (method.md (49), assumed)
  /// Classes whose boxes score like clutter (method.md 8.9, assumed).
  std::vector<std::string> clutter_like{"static-other"};
  /// Share of that logarithm for classes that the label is not the name of: a walker whom the
  /// detector also calls a cyclist scores low as one (method.md 8.9, assumed).
  double off_label_score_weight = 0.5;
  /// [m] boxes of different labels nearer than this are of one object, and the surest stands for
  /// them; 0: off. (On KITTI's training sequences the surest box names 96 % of pedestrians and of
  /// cyclists right.)
  double group_distance = 0;

  bool sizes = false;  ///< length, width, height and direction of the box are measured, too
  double axis_sigma = radians(10);                   ///< [rad] of that direction as axis (assumed)
  double heading_flip = 0.5;                         ///< reversed directions: unknown (assumed)
  double length_sigma = 0.3, width_sigma = 0.3;      ///< [m] (assumed)
  double height_sigma = 0.3, base_sigma = 0.3;       ///< [m] (assumed)
  Table length_excess, width_excess, height_excess;  ///< [m] by which a label's boxes are too large

  void visit(ParamVisitor& v);
};

/// Boxes in space as measurements of their centers: 3D detectors, GPS receivers on objects, sensors
/// that give points. Boxes are in the sensor's frame.
class PositionFrontEnd final : public FrontEnd {
 public:
  PositionFrontEnd(PositionParams params, const ClassTable& classes,
                   const DetectionModel& detection_model);

  std::vector<std::string> labelNames() const override { return params_.labels; }

 protected:
  Modality modality() const override { return modality_; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  /// What is known of one label.
  struct Label {
    ScoreOdds odds;
    double balance = 0;
    double length_excess = 0, width_excess = 0, height_excess = 0;
    /// By class: log p(label | class); share of the score's evidence that it takes.
    std::vector<double> log_label, score_share;
    double log_clutter = 0;
  };
  struct Candidate {
    const ObjectDetection* object;
    std::size_t index;
    int label;
    double log_odds = 0;  ///< of an object, by score and range
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
  Modality modality_;
  std::map<std::string, int> label_of_;
  std::vector<Label> labels_;
  std::shared_ptr<const PositionModel> model_;
};

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME] and [sensor.LABEL.positions].
std::unique_ptr<FrontEnd> makePositionFrontEnd(Config& config, const std::string& sensor_label,
                                               const ClassTable& classes);

}  // namespace perception
