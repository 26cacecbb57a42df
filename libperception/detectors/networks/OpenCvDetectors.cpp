#include <algorithm>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "libperception/detectors/CvRaster.h"
#include "libperception/detectors/Detector.h"
#include "libperception/detectors/Suppression.h"

namespace perception {
namespace {

bool admitted(const ObjectDetection& o, const std::optional<GroundGate>& gate, double low,
              double high) {
  return !gate || gate->admits(o.image_box->y1, o.image_box->y2, low, high);
}

ObjectDetection objectOf(const cv::Rect2d& box, const std::string& label, double score,
                         const Raster& image) {
  ObjectDetection o;
  o.label = label;
  o.score = score;
  o.image_box = {std::max(box.x, 0.0), std::max(box.y, 0.0),
                 std::min(box.x + box.width, image.width - 1.0),
                 std::min(box.y + box.height, image.height - 1.0)};
  return o;
}

bool isBox(const ObjectDetection& o) {
  return o.image_box->x2 > o.image_box->x1 && o.image_box->y2 > o.image_box->y1;
}

/// OpenCV's default people detector (Dalal and Triggs, INRIA).
class HogDetector final : public Detector {
 public:
  explicit HogDetector(const DetectorSetup& setup) : params_(setup.hog) {
    hog_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
    for (const auto& [name, params] : setup.models) model_ = params;
    if (setup.models.empty()) model_.low = 1, model_.high = 2.3;
    if (model_.label.empty()) model_.label = "Pedestrian";
  }

  std::vector<ObjectDetection> detect(const Raster& image,
                                      const SearchRegion& region) const override {
    cv::Mat pixels;
    cv::resize(colorMat(image), pixels, {}, params_.enlarge, params_.enlarge, cv::INTER_LINEAR);
    std::vector<ObjectDetection> out;
    if (pixels.cols < 64 || pixels.rows < 128) return out;
    std::vector<cv::Rect> boxes;
    std::vector<double> weights;
    {
      const std::lock_guard<std::mutex> lock(one_at_a_time_);
      hog_.detectMultiScale(pixels, boxes, weights, 0, {8, 8}, {0, 0}, 1.05, 0);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      // Its window is 64 x 128 around a person of 32 x 96.
      const cv::Rect& b = boxes[i];
      const double s = params_.enlarge;
      auto o = objectOf({(b.x + 0.2 * b.width) / s, (b.y + 0.1 * b.height) / s, 0.6 * b.width / s,
                         0.8 * b.height / s},
                        model_.label, weights[i], image);
      if (isBox(o) && o.score >= model_.threshold &&
          admitted(o, region.ground, model_.low, model_.high))
        out.push_back(std::move(o));
    }
    return suppressed(std::move(out), params_.overlap);
  }

 private:
  mutable std::mutex one_at_a_time_;
  HogParams params_;
  DetectorModelParams model_;
  cv::HOGDescriptor hog_;
};

}  // namespace

std::unique_ptr<Detector> makeHogDetector(const DetectorSetup& setup) {
  return std::make_unique<HogDetector>(setup);
}

}  // namespace perception
