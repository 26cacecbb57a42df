#include "gui-offscreen/drawing/Picture.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "libperception/core/Error.h"
#include "libperception/core/LowerCase.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

std::string endingOf(const std::string& path) {
  return lowerCase(std::filesystem::path(path).extension().string());
}

cv::Mat bgrOf(const Picture& picture) {
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3,
                    const_cast<std::uint8_t*>(picture.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

}  // namespace

void requirePictureName(const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") return;
  throw Error(ExitCode::kUsage, path + ": expected a picture, .png, .jpg or .jpeg");
}

// Encoded in memory and written by OutputFile: OpenCV's imwrite() does not report a full disk.
void writePicture(const std::string& path, const Picture& picture, const std::string& mark) {
  requirePictureName(path);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(endingOf(path), bgrOf(picture), bytes)) {
    throw OutputError(path + ": the picture cannot be encoded", ExitCode::kIoError);
  }
  writeFile(path, withMark({bytes.begin(), bytes.end()}, mark));
}

std::string jpegOf(const Picture& picture, int widest, int quality) {
  cv::Mat bgr = bgrOf(picture);
  if (bgr.cols > widest) {
    const int height = std::max(1, bgr.rows * widest / bgr.cols);
    cv::resize(bgr, bgr, {widest, height}, 0, 0, cv::INTER_AREA);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

Picture pictureOf(const Raster& raster) {
  Picture picture{raster.width, raster.height, {}};
  const auto pixels =
      static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
  const auto channels = static_cast<std::size_t>(raster.channels);
  if (raster.pixels.size() < pixels * channels || channels == 0) return {};
  picture.rgb.resize(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      picture.rgb[3 * i + c] = raster.pixels[i * channels + (channels >= 3 ? 2 - c : 0)];
    }
  }
  return picture;
}

}  // namespace perception
