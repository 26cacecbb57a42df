#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// An object of the truth in an image.
struct LabeledBox {
  std::string label;
  ObjectDetection::ImageBox box;
  std::optional<double> heading;  ///< [rad] KITTI's alpha
  /// Ignored, found or not: too small, truncated, occluded, or of a similar class (vans).
  bool ignore = false;
  bool area = false;  ///< a region (DontCare): boxes at least half in it are ignored
};

/// A detected box compared with the truth.
struct JudgedBox {
  double score = 0;
  bool right = false;
  double height = 0;                    ///< [px]
  std::optional<double> heading_error;  ///< [rad] (-pi, pi], of right boxes
};

/// Detection quality of one label.
struct LabelQuality {
  std::string label;
  int labeled = 0;  ///< not ignored
  int right = 0, wrong = 0;
  double average_precision = 0;                ///< area under precision (made monotone) over recall
  double recall = 0;                           ///< at the lowest score
  int headings = 0, flips = 0;                 ///< flips: errors above 90 degrees
  double heading_median = 0, heading_rms = 0;  ///< [rad] errors of the axis
  double orientation_similarity = 0;  ///< KITTI's: as average precision, with (1 + cos error) / 2
  /// Points of the curve: score, recall, precision.
  struct Point {
    double score = 0, recall = 0, precision = 0;
  };
  std::vector<Point> curve;
};

/// Compares detections with the truth image by image, by the rules of the KITTI benchmark
/// [geiger2012].
class DetectionQuality {
 public:
  /// `overlap`: least intersection over union of a right box; `min_height` [px]: smaller unmatched
  /// boxes are ignored.
  DetectionQuality(double overlap, double min_height)
      : overlap_(overlap), min_height_(min_height) {}

  void add(const std::vector<LabeledBox>& labels, const std::vector<ObjectDetection>& objects);
  /// One entry per label that was in an image or detected, ordered by name.
  std::vector<LabelQuality> results() const;
  /// All compared boxes of a label, in the order of add().
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

/// P(right | score) = 1 / (1 + exp(-slope (score - even_score))) by maximum likelihood with the
/// regularized targets of [platt1999]. Empty when all are right or all are wrong.
struct Logistic {
  double slope = 0, even_score = 0;
};
std::optional<Logistic> fitLogistic(const std::vector<JudgedBox>& boxes);

}  // namespace perception
