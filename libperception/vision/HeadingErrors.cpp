#include "libperception/vision/HeadingErrors.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"

namespace perception {

HeadingErrors readHeadingErrors(const std::string& path) {
  std::ifstream in(path);
  if (!in)
    throw DataError(fmt::format("{}: no such file (a heading head)", path), ExitCode::kNoInput);
  HeadingErrors errors;
  bool sigma = false, share = false;
  for (std::string word; !(sigma && share) && in >> word;) {
    if (word == "axis_sigma_deg") sigma = static_cast<bool>(in >> errors.axis_sigma);
    if (word == "flip_share") share = static_cast<bool>(in >> errors.flip_share);
  }
  if (!sigma || !share || !std::isfinite(errors.axis_sigma) || !std::isfinite(errors.flip_share))
    throw DataError(
        fmt::format("{}: expected a heading head with axis_sigma_deg, flip_share", path));
  errors.axis_sigma = radians(errors.axis_sigma);
  return errors;
}

}  // namespace perception
