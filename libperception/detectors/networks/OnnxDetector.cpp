#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "libperception/core/Error.h"
#include "libperception/core/system/MemoryLimit.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/detectors/CvRaster.h"
#include "libperception/detectors/Detector.h"
#include "libperception/detectors/Suppression.h"
#include "libperception/detectors/networks/OnnxOutput.h"

namespace perception {
namespace {

// [bytes] that reading and one run may take, 20 times as much as common networks of this kind; and
// each of the threads that OpenCV starts with the first run (stack and heap, reserved).
constexpr std::uint64_t kLargestNetwork = 2ULL << 30, kThread = 256ULL << 20;
constexpr double kLeastScore = 0.01;   // weaker boxes of a network are noise
constexpr double kWindowAspect = 1.3;  // ratio of sides above which square windows are added
constexpr double kTruncated = 0.03;    // of its width: a box this close to its edge is truncated

/// Networks of the YOLO kind through cv::dnn.
class OnnxDetector final : public Detector {
 public:
  explicit OnnxDetector(const DetectorSetup& setup)
      : params_(setup.onnx),
        model_(setup.models.front().second),
        path_(setup.pathOf(model_)),
        side_(params_.input) {
    if (setup.models.size() != 1)
      throw ConfigError("[detector] backend = onnx: exactly one [model.NAME] section");
    readNames();
    try {
      const ReadingScope scope(path_);
      const MemoryLimit limit(addressSpace() + kLargestNetwork +
                              static_cast<std::uint64_t>(cv::getNumThreads()) * kThread);
      net_ = cv::dnn::readNetFromONNX(path_);
      net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      run(cv::Mat::zeros(side_, side_, CV_8UC3));  // fails here when the network cannot run
    } catch (const cv::Exception& e) {
      throw DataError(fmt::format(
          "{}: cv::dnn {} cannot run this network at an input of {} px ([onnx] input): {}. Export "
          "it with a fixed input size, opset 12 or lower and simplified, without suppression of "
          "boxes inside",
          path_, CV_VERSION, side_, e.err));
    }
    layout_ = layoutOf();
  }

  std::vector<ObjectDetection> detect(const Raster& image,
                                      const SearchRegion& region) const override {
    const cv::Mat pixels = colorMat(image);
    std::vector<ObjectDetection> out;
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    const cv::Size whole(image.width, image.height);
    for (const cv::Rect& window : windowsOf(whole)) detectIn(pixels, window, region, out);
    return suppressed(std::move(out), params_.overlap);
  }

 private:
  /// The whole image and, if it is long, square windows along it that overlap by `window_overlap`:
  /// scaling an image of 1242 px to 416 px would shrink a car of 40 px to 13.
  std::vector<cv::Rect> windowsOf(const cv::Size& image) const {
    std::vector<cv::Rect> out{{{0, 0}, image}};
    const int side = std::min(image.width, image.height);
    const int length = std::max(image.width, image.height);
    if (!params_.windows || length < kWindowAspect * side || length <= side_) return out;
    const double step = (1 - params_.window_overlap) * side;
    const int count = 1 + static_cast<int>(std::ceil((length - side) / step));
    for (int i = 0; i < count; ++i) {
      const int begin = static_cast<int>(static_cast<long>(length - side) * i / (count - 1));
      out.emplace_back(image.width > image.height ? begin : 0,
                       image.width > image.height ? 0 : begin, side, side);
    }
    return out;
  }

  /// Detects in one window, without boxes truncated by it, which are whole in others.
  void detectIn(const cv::Mat& pixels, const cv::Rect& window, const SearchRegion& region,
                std::vector<ObjectDetection>& out) const {
    const double scale = std::min(static_cast<double>(side_) / window.width,
                                  static_cast<double>(side_) / window.height);
    cv::Mat input(side_, side_, CV_8UC3,
                  cv::Scalar::all(114));  // padding with the gray of training
    cv::Mat part = input(cv::Rect(0, 0, std::max(1, cvRound(window.width * scale)),
                                  std::max(1, cvRound(window.height * scale))));
    cv::resize(pixels(window), part, part.size(), 0, 0, cv::INTER_LINEAR);
    const cv::Mat output = run(input);
    for (const OnnxBox& b : decodeOnnxOutput(reinterpret_cast<const float*>(output.data),
                                             {output.size[1], output.size[2]}, layout_, side_,
                                             std::max(kLeastScore, model_.threshold))) {
      const auto name = names_.find(b.index);
      if (name == names_.end()) continue;
      const double border = kTruncated * (b.box.x2 - b.box.x1) / scale;
      const double x1 = window.x + b.box.x1 / scale, x2 = window.x + b.box.x2 / scale;
      const double y1 = window.y + b.box.y1 / scale, y2 = window.y + b.box.y2 / scale;
      const bool cut = (window.x > 0 && x1 < window.x + border) ||
                       (window.y > 0 && y1 < window.y + border) ||
                       (window.br().x < pixels.cols && x2 > window.br().x - border) ||
                       (window.br().y < pixels.rows && y2 > window.br().y - border);
      ObjectDetection o;
      o.label = name->second;
      o.score = b.score;
      o.image_box = {std::max(0.0, x1), std::max(0.0, y1), std::min(pixels.cols - 1.0, x2),
                     std::min(pixels.rows - 1.0, y2)};
      if (cut || !(o.image_box->x2 > o.image_box->x1) || !(o.image_box->y2 > o.image_box->y1))
        continue;
      if (region.ground &&
          !region.ground->admits(o.image_box->y1, o.image_box->y2, model_.low, model_.high))
        continue;
      out.push_back(std::move(o));
    }
  }

  void readNames() {
    for (const std::string& word : model_.names) {
      int index = -1;
      const auto equals = word.find('=');
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
      if (error != std::errc() || equals == std::string::npos || end != word.data() + equals ||
          equals + 1 == word.size())
        throw ConfigError(fmt::format("names: '{}' is not INDEX=LABEL", word));
      names_[index] = word.substr(equals + 1);
    }
    if (names_.empty())
      throw ConfigError("[model] names: expected the classes to report (2=Car, ...)");
  }

  /// Runs the network; returns its first output, 1 x A x B.
  cv::Mat run(const cv::Mat& input) const {
    const bool yolox = layout_ == OnnxLayout::kYolox;
    // YOLOX takes blue, green, red from 0 to 255; the others red, green, blue from 0 to 1.
    net_.setInput(cv::dnn::blobFromImage(input, yolox ? 1.0 : 1 / 255.0, input.size(), {}, !yolox));
    std::vector<cv::Mat> outputs;
    net_.forward(outputs, net_.getUnconnectedOutLayersNames());
    if (outputs.empty() || outputs[0].dims != 3 || outputs[0].size[0] != 1 ||
        outputs[0].type() != CV_32F) {
      throw DataError(fmt::format(
          "{}: its first output is not 1 x boxes x values: not a YOLOX, YOLOv5 or YOLOv8 export",
          path_));
    }
    return outputs[0];
  }

  OnnxLayout layoutOf() {
    const cv::Mat output = run(cv::Mat::zeros(side_, side_, CV_8UC3));
    const OnnxShape shape{output.size[1], output.size[2]};
    const OnnxLayout layout = params_.layout == 0 ? guessOnnxLayout(shape, side_)
                                                  : static_cast<OnnxLayout>(params_.layout);
    if (!fitsOnnxLayout(shape, layout, side_))
      throw DataError(fmt::format(
          "{}: output of {} x {} at an input of {} px: not the layout of YOLOX, YOLOv5 or YOLOv8",
          path_, shape.rows, shape.columns, side_));
    return layout;
  }

  OnnxParams params_;
  DetectorModelParams model_;
  std::string path_;
  int side_ = 0;  // [px] of the square input
  OnnxLayout layout_ = OnnxLayout::kUnknown;
  std::map<int, std::string> names_;
  mutable std::mutex one_at_a_time_;
  mutable cv::dnn::Net net_;
};

}  // namespace

std::unique_ptr<Detector> makeOnnxDetector(const DetectorSetup& setup) {
  return std::make_unique<OnnxDetector>(setup);
}

}  // namespace perception
