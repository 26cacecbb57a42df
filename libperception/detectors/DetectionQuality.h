#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// What an image really shows.
struct LabeledBox {
  std::string label;
  ObjectDetection::ImageBox box;
  std::optional<double> heading;  ///< [rad] KITTI's alpha
  /// Neither to be found nor wrong when found as `label`: too small, cut off, hidden, kindred
  /// (vans).
  bool ignore = false;
  bool area = false;  ///< a region (DontCare): boxes that lie in it by half do not count
};

/// One box of a detector after comparison with the labels.
struct JudgedBox {
  double score = 0;
  bool right = false;
  double height = 0;                    ///< [px]
  std::optional<double> heading_error;  ///< [rad] (-pi, pi], of right boxes
};

/// How good boxes of one label are.
struct LabelQuality {
  std::string label;
  int labeled = 0;  ///< to be found
  int right = 0, wrong = 0;
  double average_precision = 0;                ///< area under precision (made monotone) over recall
  double recall = 0;                           ///< at the lowest score
  int headings = 0, flips = 0;                 ///< flips: more than 90 degrees off
  double heading_median = 0, heading_rms = 0;  ///< [rad] of the axis: flips turned back
  double orientation_similarity = 0;  ///< KITTI's: as average precision, with (1 + cos error) / 2
  /// Points of the curve: score, recall, precision.
  struct Point {
    double score = 0, recall = 0, precision = 0;
  };
  std::vector<Point> curve;
};

/// Compares detections with labels image by image, by the rules of KITTI's benchmark.
class DetectionQuality {
 public:
  /// `overlap`: intersection over union of a right box; `min_height` [px]: smaller boxes that hit
  /// nothing do not count.
  DetectionQuality(double overlap, double min_height)
      : overlap_(overlap), min_height_(min_height) {}

  void add(const std::vector<LabeledBox>& labels, const std::vector<ObjectDetection>& objects);
  /// Labels that stood in an image or were detected, in order of their names.
  std::vector<LabelQuality> results() const;
  /// All judged boxes of a label, as they came.
  const std::vector<JudgedBox>& judged(const std::string& label) const;
  std::vector<std::string> labels() const;

 private:
  struct Row {
    int labeled = 0;
    std::vector<JudgedBox> boxes;
  };
  void addLabel(const std::string& name, const std::vector<LabeledBox>& labels,
                const std::vector<ObjectDetection>& objects);
  double overlap_, min_height_;
  std::map<std::string, Row> rows_;
};

/// P(right | score) = 1 / (1 + exp(-slope (score - even_score))) by maximum likelihood, with two
/// boxes' worth of prior ([platt1999]: targets a little off 0 and 1). Empty when all are right or
/// all are wrong.
struct Logistic {
  double slope = 0, even_score = 0;
};
std::optional<Logistic> fitLogistic(const std::vector<JudgedBox>& boxes);

}  // namespace perception
