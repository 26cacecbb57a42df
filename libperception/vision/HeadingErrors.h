#pragma once
#include <string>

namespace perception {

/// How wrong the headings of a trained heading head are, measured on images that it did not learn
/// from: the head of the file that perception-detect --train writes.
struct HeadingErrors {
  double axis_sigma = 0;  ///< [rad] rms of the axis, reversals turned back
  double flip_share = 0;  ///< front taken for back, in [0, 1]
};

/// Throws DataError, naming the file.
HeadingErrors readHeadingErrors(const std::string& path);

}  // namespace perception
