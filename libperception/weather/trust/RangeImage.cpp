#include "libperception/weather/trust/RangeImage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {
namespace {

constexpr float kSteepest = 1;  // tangent of elevation; steeper beams go into the outermost rows
constexpr float kInstrument = 0.3F;  // [m] nearer returns are of the sensor's window
constexpr double kConnected = 0.6;   // share of pixels with a neighbor above or below
// [rad] 64 and 128 beams, 32, 16, and a few layers (Ibeo).
const double kRows[] = {radians(0.35), radians(0.5), radians(0.7), radians(1.0),
                        radians(1.4),  radians(2.0), radians(3.0)};

/// Layout of the pixels.
struct PixelRules {
  float per_radian, rows_per_slope;
  std::int32_t columns, stride;
};

/// The first and the last of some numbers.
struct Span {
  std::int32_t first, last;
};

/// Ranges [m] of `count` points [m] and their pixels, both 0 for invalid points. Returns `columns`,
/// widened by those of the others.
PERCEPTION_WIDEST Span findPixels(const float* __restrict x, const float* __restrict y,
                                  const float* __restrict z, std::size_t count, const PixelRules k,
                                  Span columns, float* __restrict range,
                                  std::uint32_t* __restrict pixels) {
  std::int32_t left = columns.first, right = columns.last;
  for (std::size_t i = 0; i < count; ++i) {
    const float flat2 = x[i] * x[i] + y[i] * y[i];
    const float r = std::sqrt(flat2 + z[i] * z[i]);
    const float slope = z[i] / (std::sqrt(flat2) + 1e-6F);
    const std::int32_t seen = (r > kInstrument) & (r < 1e3F);  // NaN fails both
    const auto turn =
        static_cast<std::int32_t>((fastAtan2(x[i], y[i]) + static_cast<float>(kPi)) * k.per_radian);
    const std::int32_t column = turn < k.columns - 1 ? turn : k.columns - 1;
    const float high = slope < kSteepest ? slope : kSteepest;
    const float up = (high > -kSteepest ? high : -kSteepest) + kSteepest;
    const std::int32_t row =
        static_cast<std::int32_t>(up * k.rows_per_slope) + RangeImage::kRowReach;
    const std::int32_t pixel = row * k.stride + column + RangeImage::kColumnReach;
    range[i] = seen != 0 ? r : 0.0F;
    pixels[i] = static_cast<std::uint32_t>(seen != 0 ? pixel : 0);
    const std::int32_t from = seen != 0 ? column : k.columns, to = seen != 0 ? column : 0;
    left = from < left ? from : left, right = to > right ? to : right;
  }
  return {left, right};
}

/// The first and the last pixel with a return.
struct PixelSpan {
  std::uint32_t first, last;
};

PERCEPTION_WIDEST PixelSpan widened(const std::uint32_t* pixels, std::size_t count,
                                    PixelSpan span) {
  std::uint32_t before_first = span.first - 1, last = span.last;
  for (std::size_t i = 0; i < count; ++i) {
    before_first = std::min(before_first, pixels[i] - 1);  // no range wraps to the largest number
    last = std::max(last, pixels[i]);
  }
  return {before_first + 1, last};
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

// Processes block by block, so that intermediate results stay in the L1 cache.
void RangeImage::place(const LidarCloud& cloud, const BlockVisitor& look) {
  std::array<float, kBlock> ranges;
  std::array<std::uint32_t, kBlock> pixels;
  const PixelRules rules{per_radian_, rows_per_slope_, static_cast<std::int32_t>(columns_),
                         static_cast<std::int32_t>(stride_)};
  const auto stride = static_cast<std::uint32_t>(stride_);
  PixelSpan span{static_cast<std::uint32_t>(rows_ + kRowReach) * stride, 0};
  Span columns{rules.columns, 0};
  float* image = image_.data();
  for (std::size_t first = 0; first < cloud.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, cloud.size() - first);
    columns = findPixels(&cloud.x[first], &cloud.y[first], &cloud.z[first], count, rules, columns,
                         ranges.data(), pixels.data());
    span = widened(pixels.data(), count, span);
    for (std::size_t k = 0; k < count; ++k) image[pixels[k]] = ranges[k];
    if (look) look({first, count, ranges.data(), pixels.data()});
  }
  image[0] = 0;
  lowest_ = span.first / stride, highest_ = span.last / stride;
  left_ = static_cast<std::size_t>(columns.first), right_ = static_cast<std::size_t>(columns.last);
}

// Share of pixels with a return that have another in the row above or below.
double RangeImage::connectedShare(const LidarCloud& cloud, double row) const {
  RangeImage other(column_, row);
  other.layOut(row);
  other.wipe();
  other.place(cloud, {});
  std::size_t all = 0, connected = 0;
  const auto filled = [](const float* pixel) {
    return (pixel[-1] > 0) | (pixel[0] > 0) | (pixel[1] > 0);
  };
  for (std::size_t line = other.lowest_; line <= other.highest_; ++line) {
    const float* pixel = other.image_.data() + static_cast<std::ptrdiff_t>(line) * other.stride_;
    for (const float* end = pixel + other.stride_; pixel != end; ++pixel) {
      if (!(*pixel > 0)) continue;
      ++all;
      connected += filled(pixel - other.stride_) || filled(pixel + other.stride_);
    }
  }
  return all == 0 ? 0 : static_cast<double>(connected) / static_cast<double>(all);
}

double RangeImage::findRow(const LidarCloud& cloud) const {
  for (const double row : kRows)
    if (connectedShare(cloud, row) >= kConnected) return row;
  return *(std::end(kRows) - 1);
}

// Rows and columns without returns are zero already.
void RangeImage::wipe() {
  const auto stride = static_cast<std::size_t>(stride_);
  image_.resize((rows_ + 2 * kRowReach) * stride + kSlack);
  for (std::size_t row = lowest_; row <= highest_; ++row) {
    float* const line = image_.data() + row * stride;
    std::fill_n(line, kColumnReach, 0.0F);
    std::fill(line + kColumnReach + left_, line + kColumnReach + right_ + 1, 0.0F);
    std::fill_n(line + kColumnReach + columns_, kColumnReach, 0.0F);
  }
}

void RangeImage::fill(const LidarCloud& cloud, const BlockVisitor& look) {
  if (rows_ == 0) layOut(row_ > 0 ? row_ : findRow(cloud));
  wipe();
  place(cloud, look);
  for (std::size_t row = lowest_; row <= highest_; ++row) {
    float* line = image_.data() + row * static_cast<std::size_t>(stride_);
    std::copy(line + columns_, line + columns_ + kColumnReach, line);
    std::copy(line + kColumnReach, line + 2 * kColumnReach, line + kColumnReach + columns_);
  }
}

std::size_t RangeImage::memoryBytes() const { return sizeof(float) * image_.capacity(); }

}  // namespace perception
