#include "gui-offscreen/Picture.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/scene/OutputFile.h"

namespace perception {

std::size_t colorsOf(const Picture& picture) {
  std::set<std::uint32_t> colors;
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    colors.insert(static_cast<std::uint32_t>(picture.rgb[i] << 16 | picture.rgb[i + 1] << 8 |
                                             picture.rgb[i + 2]));
  }
  return colors.size();
}

// Encoded in memory and written by our own file class: OpenCV's imwrite() says nothing of a full
// disk.
void writePng(const std::string& path, const Picture& picture) {
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3,
                    const_cast<std::uint8_t*>(picture.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) {
    throw OutputError(path + ": the picture cannot be encoded", ExitCode::kIoError);
  }
  writeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace perception
