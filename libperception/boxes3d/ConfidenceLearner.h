#pragma once
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/boxes3d/ScoreOdds.h"
#include "libperception/measurement/frames/FramePreparation.h"

namespace perception {

/// Logistic regression of "the next three frames have the box, too" on score and range, with a
/// prior wide enough for any scale of scores: Laplace's approximation of its posterior,
/// method.md 8.12.
class PersistenceFit {
 public:
  struct Sample {
    double score = 0, range = 0;  ///< [-], [m]
    bool persists = false;
  };
  /// Keeps the newest samples.
  void add(const Sample& sample);
  /// Unit of the scores before there are samples.
  void start(const std::vector<double>& scores);
  void fit();

  /// Log-odds that a box is an object, averaged over the uncertainty of the fit.
  double logOdds(double score, double range) const;
  /// The same without that uncertainty, as [sensor.LABEL.positions] has it.
  ScoreOdds odds() const;
  std::size_t samples() const { return samples_.size(); }

 private:
  Vector3 rowOf(double score, double range) const;
  void standardize();

  std::deque<Sample> samples_;
  double center_ = 0, unit_ = 1;  ///< of the scores: mean and standard deviation
  bool scaled_ = false;
  Vector3 weights_ = Vector3(0, 1, 0);
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Identity();
};

/// Replaces the scores of a detector's 3D boxes by log p(score | object) / p(score | clutter),
/// learned while running: no detector's scale of scores is known. What is there stays there: boxes
/// that the next frames have again are objects more often than those that they have not, and how
/// often follows one law for different networks (method.md 8.12).
class ConfidenceLearner final : public FramePreparation {
 public:
  struct Params {
    std::map<std::string, int> label_of;  ///< the detector's class names; others are left alone
    std::vector<std::string> labels;
    double fov = kTwoPi;          ///< [rad] of the sensor
    double clutter_per_scan = 1;  ///< for which the ratios are made
  };
  explicit ConfidenceLearner(Params params);

  /// Learns from the frame; by box the log-odds that it is an object of its label, NaN where no
  /// label has its name.
  std::vector<double> learn(const SensorFrame& frame);
  void apply(SensorFrame& frame) override;
  void restart() override { last_.clear(); }
  std::vector<std::string> learned() const override;

 private:
  struct Box {
    int label;
    Vector2 place;  ///< [m] world
    double score, range;
    bool stays_in_view;  ///< whatever it does until the next frames
    int before = -1;     ///< index in the frame before; -1: not there
  };
  struct Frame {
    Stamp stamp;
    std::vector<Box> boxes;
  };
  struct Label {
    PersistenceFit fit;
    std::optional<double> objects;  ///< expected number in a frame, mean of the last ones
    int frames = 0;
  };
  Frame boxesOf(const SensorFrame& frame) const;
  void link(Frame& now) const;
  int tracedBack(const Frame& now, const Box& box) const;
  void addSamples(const Frame& now);

  Params params_;
  std::vector<Label> labels_;
  std::deque<Frame> last_;  ///< the newest at the back; at most kFrames
};

}  // namespace perception
