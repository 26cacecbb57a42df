#pragma once
#include <string>

namespace cv {
class Mat;
}

namespace perception {

/// A picture file as data of others (core/system/Supervision.h): decoded by OpenCV with its imread
/// flags; empty where it cannot be. Throws cv::Exception for sizes beyond OpenCV's limits.
cv::Mat readImageFile(const std::string& path, int flags);

}  // namespace perception
