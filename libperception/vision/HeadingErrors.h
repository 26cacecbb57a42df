#pragma once
#include <string>

namespace perception {

/// Errors of the headings of a trained HeadingHead, cross-validated: header of the file that
/// perception-detect --train writes.
struct HeadingErrors {
  double axis_sigma = 0;  ///< [rad] rms error of the axis
  double flip_share = 0;  ///< share of reversed headings, in [0, 1]
};

/// Throws DataError, naming the file.
HeadingErrors readHeadingErrors(const std::string& path);

}  // namespace perception
