#include "libperception/weather/RangeImage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/core/Lanes.h"
#include "libperception/core/RoughBearing.h"
#include "libperception/core/Wider.h"

namespace perception {
namespace {

constexpr float kSteepest = 1;       // tangent of elevation; steeper beams share the outermost rows
constexpr float kInstrument = 0.3F;  // [m] nearer is the sensor's own window
constexpr double kConnected = 0.6;   // share of pixels with a neighbour above or below
// [rad] 64 and 128 beams, 32, 16, and a few layers (Ibeo).
const double kRows[] = {radians(0.35), radians(0.5), radians(0.7), radians(1.0),
                        radians(1.4),  radians(2.0), radians(3.0)};

/// How RangeImage lays its pixels out.
struct PixelRules {
  float per_radian, rows_per_slope;
  std::int32_t columns, stride;
};

/// Of `count` points [m]: range [m], azimuth [rad], tangent of elevation.
PERCEPTION_WIDER void findDirections(const float* __restrict x, const float* __restrict y,
                                     const float* __restrict z, std::size_t count,
                                     float* __restrict range, float* __restrict azimuth,
                                     float* __restrict slope) {
  for (std::size_t i = 0; i < count; ++i) {
    const float flat2 = x[i] * x[i] + y[i] * y[i];
    const float r = std::sqrt(flat2 + z[i] * z[i]);
    azimuth[i] = roughBearing(x[i], y[i]);
    slope[i] = z[i] / (std::sqrt(flat2) + 1e-6F);
    range[i] = (r > kInstrument) & (r < 1e3F) ? r : 0.0F;  // NaN fails both
  }
}

/// Pixels of directions; 0 where there is no range.
PERCEPTION_WIDER void findPixels(const float* __restrict range, const float* __restrict azimuth,
                                 const float* __restrict slope, std::size_t count, PixelRules k,
                                 std::uint32_t* __restrict pixels) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto turn =
        static_cast<std::int32_t>((azimuth[i] + static_cast<float>(kPi)) * k.per_radian);
    const std::int32_t column = turn < k.columns - 1 ? turn : k.columns - 1;
    const float high = slope[i] < kSteepest ? slope[i] : kSteepest;
    const float up = (high > -kSteepest ? high : -kSteepest) + kSteepest;
    const std::int32_t row =
        static_cast<std::int32_t>(up * k.rows_per_slope) + RangeImage::kRowReach;
    const std::int32_t pixel = row * k.stride + column + RangeImage::kColumnReach;
    pixels[i] = static_cast<std::uint32_t>(range[i] > 0 ? pixel : 0);
  }
}

/// The first and the last pixel with a return.
struct PixelSpan {
  std::int32_t first, last;
};

PERCEPTION_WIDER PixelSpan widened(const std::uint32_t* pixels, std::size_t count, PixelSpan span) {
  Int8 first = eight(span.first), last = eight(span.last);
  for (std::size_t i = 0; i < count; i += kLanes) {
    Int8 some = eight(0);
    std::memcpy(&some, pixels + i,
                i + kLanes <= count ? sizeof some : (count - i) * sizeof *pixels);
    last = larger(last, some);
    first = smaller(first, some == 0 ? first : some);  // 0: no range
  }
  for (int k = 0; k < kLanes; ++k) {
    span.first = std::min(span.first, first[k]);
    span.last = std::max(span.last, last[k]);
  }
  return span;
}

}  // namespace

RangeImage::RangeImage(double column, double row)
    : column_(column),
      row_(row),
      columns_(std::max<std::size_t>(2 * kColumnReach,
                                     static_cast<std::size_t>(std::lround(kTwoPi / column)))) {}

void RangeImage::layOut(double row) {
  row_ = row;
  rows_ = static_cast<std::size_t>(2 * static_cast<double>(kSteepest) / row_) + 1;
  rows_per_slope_ = static_cast<float>(1 / row_);
  per_radian_ = static_cast<float>(static_cast<double>(columns_) / kTwoPi);
  stride_ = static_cast<std::ptrdiff_t>(columns_ + 2 * kColumnReach);
}

// Range and pixel of each return, block by block: directions never leave the nearest cache.
void RangeImage::place(const LidarCloud& cloud, const BlockVisitor& look) {
  constexpr std::size_t kBlock = 1024;
  std::array<float, kBlock> azimuth, slope;
  const PixelRules rules{per_radian_, rows_per_slope_, static_cast<std::int32_t>(columns_),
                         static_cast<std::int32_t>(stride_)};
  ranges_.resize(cloud.size()), pixels_.resize(cloud.size());
  PixelSpan span{static_cast<std::int32_t>(rows_ + kRowReach) * rules.stride, 0};
  for (std::size_t first = 0; first < cloud.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, cloud.size() - first);
    findDirections(&cloud.x[first], &cloud.y[first], &cloud.z[first], count, &ranges_[first],
                   azimuth.data(), slope.data());
    findPixels(&ranges_[first], azimuth.data(), slope.data(), count, rules, &pixels_[first]);
    span = widened(&pixels_[first], count, span);
    if (look) look(first, count);
  }
  const auto stride = static_cast<std::int32_t>(stride_);
  lowest_ = static_cast<std::size_t>(span.first / stride);
  highest_ = static_cast<std::size_t>(span.last / stride);
}

// Of the directions with a return, how many have one in the row above or below.
double RangeImage::connectedShare(const LidarCloud& cloud, double row) const {
  RangeImage other(column_, row);
  other.layOut(row);
  other.place(cloud);
  std::vector<char> filled((other.rows_ + 2 * kRowReach) * static_cast<std::size_t>(other.stride_));
  for (const std::uint32_t pixel : other.pixels_) filled[pixel] = 1;
  filled[0] = 0;
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

double RangeImage::findRow(const LidarCloud& cloud) const {
  for (const double row : kRows)
    if (connectedShare(cloud, row) >= kConnected) return row;
  return *(std::end(kRows) - 1);
}

// Rows without returns are empty already.
void RangeImage::wipe() {
  const auto stride = static_cast<std::size_t>(stride_);
  image_.resize((rows_ + 2 * kRowReach) * stride);
  if (highest_ >= lowest_)
    std::fill_n(image_.begin() + static_cast<std::ptrdiff_t>(lowest_ * stride),
                (highest_ + 1 - lowest_) * stride, 0.0F);
}

void RangeImage::fill(const LidarCloud& cloud, const BlockVisitor& look) {
  if (rows_ == 0) layOut(row_ > 0 ? row_ : findRow(cloud));
  wipe();
  place(cloud, look);
  float* image = image_.data();
  for (std::size_t i = 0; i < ranges_.size(); ++i) image[pixels_[i]] = ranges_[i];
  image[0] = 0;
  for (std::size_t row = lowest_; row <= highest_; ++row) {
    float* line = image + row * static_cast<std::size_t>(stride_);
    std::copy(line + columns_, line + columns_ + kColumnReach, line);
    std::copy(line + kColumnReach, line + 2 * kColumnReach, line + kColumnReach + columns_);
  }
}

std::size_t RangeImage::memoryBytes() const {
  return sizeof(float) * (ranges_.capacity() + image_.capacity()) +
         sizeof(std::uint32_t) * pixels_.capacity();
}

}  // namespace perception
