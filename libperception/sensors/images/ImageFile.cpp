#include "libperception/sensors/images/ImageFile.h"

#include <opencv2/imgcodecs.hpp>

#include "libperception/core/system/Supervision.h"

namespace perception {

cv::Mat readImageFile(const std::string& path, int flags) {
  const ReadingScope scope(path);
  return cv::imread(path, flags);
}

}  // namespace perception
