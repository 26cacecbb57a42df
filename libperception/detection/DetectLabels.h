#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/detectors/DetectionQuality.h"

namespace perception {

/// Criteria of counted labels.
struct LabelRules {
  double min_height = 25;       ///< [px]
  double max_truncation = 0.3;  ///< share outside of the image
  int max_occlusion = 1;        ///< KITTI: 0 = fully visible, 1 = partly, 2 = largely
};

/// Truth of images: a folder of KITTI's object labels (NAME.txt beside NAME.png), or a CSV with the
/// columns image, class, x1, y1, x2, y2 and optionally ignore, occluded, heading_deg.
class ImageLabels {
 public:
  /// Throws DataError.
  ImageLabels(const std::string& path, LabelRules rules);
  /// Labels of the image with this file name. Throws DataError if a folder lacks its file.
  std::vector<LabeledBox> of(const std::string& file_name) const;

 private:
  std::string path_;
  LabelRules rules_;
  std::map<std::string, std::vector<LabeledBox>> by_image_;  ///< of a CSV
  bool folder_ = false;
};

}  // namespace perception
