#include "libperception/weather/RangeImage.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/core/RoughBearing.h"

namespace perception {
namespace {

constexpr float kSteepest = 1;       // tangent of elevation; steeper beams share the outermost rows
constexpr float kInstrument = 0.3F;  // [m] nearer is the sensor's own window
constexpr double kConnected = 0.6;   // share of pixels with a neighbour above or below
// [rad] 64 and 128 beams, 32, 16, and a few layers (Ibeo).
const double kRows[] = {radians(0.35), radians(0.5), radians(0.7), radians(1.0),
                        radians(1.4),  radians(2.0), radians(3.0)};

}  // namespace

RangeImage::RangeImage(double column, double row)
    : column_(column),
      row_(row),
      columns_(std::max<std::size_t>(2 * kColumnReach,
                                     static_cast<std::size_t>(std::lround(kTwoPi / column)))) {}

void RangeImage::directions(const LidarCloud& cloud) {
  const std::size_t count = cloud.size();
  ranges_.resize(count), azimuth_.resize(count), slope_.resize(count), pixels_.resize(count);
  const float *x = cloud.x.data(), *y = cloud.y.data(), *z = cloud.z.data();
  float *range = ranges_.data(), *azimuth = azimuth_.data(), *slope = slope_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float flat2 = x[i] * x[i] + y[i] * y[i];
    const float r = std::sqrt(flat2 + z[i] * z[i]);
    azimuth[i] = roughBearing(x[i], y[i]);
    slope[i] = z[i] / (std::sqrt(flat2) + 1e-6F);
    range[i] = r > kInstrument && r < 1e3F ? r : 0.0F;  // NaN fails both
  }
}

void RangeImage::layOut(double row) {
  row_ = row;
  rows_ = static_cast<std::size_t>(2 * static_cast<double>(kSteepest) / row_) + 1;
  rows_per_slope_ = static_cast<float>(1 / row_);
  per_radian_ = static_cast<float>(static_cast<double>(columns_) / kTwoPi);
  stride_ = static_cast<std::ptrdiff_t>(columns_ + 2 * kColumnReach);
}

std::uint32_t RangeImage::pixelAt(float azimuth, float slope) const {
  const int column = std::min(static_cast<int>((azimuth + static_cast<float>(kPi)) * per_radian_),
                              static_cast<int>(columns_) - 1);
  const float up = std::clamp(slope, -kSteepest, kSteepest) + kSteepest;
  const int row = static_cast<int>(up * rows_per_slope_) + kRowReach;
  return static_cast<std::uint32_t>(row * static_cast<int>(stride_) + column + kColumnReach);
}

// Of the directions with a return, how many have one in the row above or below.
double RangeImage::connectedShare(double row) const {
  RangeImage other(column_, row);
  other.layOut(row);
  std::vector<char> filled((other.rows_ + 2 * kRowReach) * static_cast<std::size_t>(other.stride_));
  for (std::size_t i = 0; i < ranges_.size(); ++i)
    if (ranges_[i] > 0) filled[other.pixelAt(azimuth_[i], slope_[i])] = 1;
  std::size_t all = 0, connected = 0;
  const auto stride = static_cast<std::size_t>(other.stride_);
  for (std::size_t p = stride + 1; p + stride + 1 < filled.size(); ++p) {
    if (!filled[p]) continue;
    ++all;
    const char *below = &filled[p - stride], *above = &filled[p + stride];
    connected += below[-1] || below[0] || below[1] || above[-1] || above[0] || above[1];
  }
  return all == 0 ? 0 : static_cast<double>(connected) / static_cast<double>(all);
}

double RangeImage::findRow() {
  for (const double row : kRows)
    if (connectedShare(row) >= kConnected) return row;
  return *(std::end(kRows) - 1);
}

void RangeImage::fill(const LidarCloud& cloud) {
  directions(cloud);
  if (rows_ == 0) layOut(row_ > 0 ? row_ : findRow());
  image_.assign((rows_ + 2 * kRowReach) * static_cast<std::size_t>(stride_), 0.0F);
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const std::uint32_t pixel = ranges_[i] > 0 ? pixelAt(azimuth_[i], slope_[i]) : 0;
    pixels_[i] = pixel;
    image_[pixel] = ranges_[i];
  }
  image_[0] = 0;
  for (std::size_t row = kRowReach; row < rows_ + kRowReach; ++row) {
    float* line = image_.data() + row * static_cast<std::size_t>(stride_);
    std::copy(line + columns_, line + columns_ + kColumnReach, line);
    std::copy(line + kColumnReach, line + 2 * kColumnReach, line + kColumnReach + columns_);
  }
}

std::size_t RangeImage::memoryBytes() const {
  return sizeof(float) *
             (ranges_.capacity() + azimuth_.capacity() + slope_.capacity() + image_.capacity()) +
         sizeof(std::uint32_t) * pixels_.capacity();
}

}  // namespace perception
