#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception::ros {
namespace {

/// What pixels of an encoding are: bytes each, and of these blue, green and red (or the brightest
/// byte of a gray value).
struct PixelLayout {
  const char* encoding;
  std::size_t bytes;
  std::vector<std::size_t> use;
  bool wide = false;  ///< two bytes a value, the second is the higher one
};

const std::vector<PixelLayout>& pixelLayouts() {
  static const std::vector<PixelLayout> layouts = {{"mono8", 1, {0}},
                                                   {"8UC1", 1, {0}},
                                                   {"mono16", 2, {1}, true},
                                                   {"16UC1", 2, {1}, true},
                                                   {"bgr8", 3, {0, 1, 2}},
                                                   {"8UC3", 3, {0, 1, 2}},
                                                   {"rgb8", 3, {2, 1, 0}},
                                                   {"bgra8", 4, {0, 1, 2}},
                                                   {"8UC4", 4, {0, 1, 2}},
                                                   {"rgba8", 4, {2, 1, 0}},
                                                   {"bgr16", 6, {1, 3, 5}, true},
                                                   {"16UC3", 6, {1, 3, 5}, true},
                                                   {"rgb16", 6, {5, 3, 1}, true},
                                                   {"bgra16", 8, {1, 3, 5}, true},
                                                   {"rgba16", 8, {5, 3, 1}, true}};
  return layouts;
}

/// Pixels whose colors lie in several of them. `code`: of cv::cvtColor to blue, green, red, whose
/// Bayer patterns are named by the second row's second and third pixel.
struct MixedLayout {
  const char* encoding;
  std::size_t bytes;  ///< of a pixel in a row
  int code;
  bool wide = false;
  bool planes = false;  ///< half as many rows of colors behind those of the brightness
};

const std::vector<MixedLayout>& mixedLayouts() {
  static const std::vector<MixedLayout> layouts = {
      {"bayer_rggb8", 1, cv::COLOR_BayerBG2BGR},
      {"bayer_bggr8", 1, cv::COLOR_BayerRG2BGR},
      {"bayer_gbrg8", 1, cv::COLOR_BayerGR2BGR},
      {"bayer_grbg8", 1, cv::COLOR_BayerGB2BGR},
      {"bayer_rggb16", 2, cv::COLOR_BayerBG2BGR, true},
      {"bayer_bggr16", 2, cv::COLOR_BayerRG2BGR, true},
      {"bayer_gbrg16", 2, cv::COLOR_BayerGR2BGR, true},
      {"bayer_grbg16", 2, cv::COLOR_BayerGB2BGR, true},
      {"yuv422", 2, cv::COLOR_YUV2BGR_UYVY},
      {"uyvy", 2, cv::COLOR_YUV2BGR_UYVY},
      {"yuv422_yuy2", 2, cv::COLOR_YUV2BGR_YUY2},
      {"yuyv", 2, cv::COLOR_YUV2BGR_YUY2},
      {"nv12", 1, cv::COLOR_YUV2BGR_NV12, false, true},
      {"nv21", 1, cv::COLOR_YUV2BGR_NV21, false, true}};
  return layouts;
}

template <class Layout>
const Layout* layoutOf(const std::vector<Layout>& layouts, const std::string& encoding) {
  const auto found = std::find_if(layouts.begin(), layouts.end(), [&](const Layout& layout) {
    return layout.encoding == encoding;
  });
  return found == layouts.end() ? nullptr : &*found;
}

/// Throws std::runtime_error: `rows` rows of `row` bytes are not there.
void checkBytes(const Image& m, std::uint64_t row, std::uint64_t rows) {
  if (m.width == 0 || m.height == 0 || m.step < row || m.data.size() < (rows - 1) * m.step + row) {
    throw std::runtime_error(fmt::format("{} bytes for an image of {} x {} {}", m.data.size(),
                                         m.width, m.height, m.encoding));
  }
}

Raster rasterOf(const cv::Mat& image) {
  Raster raster;
  raster.width = image.cols;
  raster.height = image.rows;
  raster.pixels.assign(image.datastart, image.dataend);
  return raster;
}

Raster mixedRaster(const Image& m, const MixedLayout& layout) {
  constexpr std::uint32_t kMostPixels = 1U << 15U;
  if (m.width % 2 != 0 || m.height % 2 != 0 || m.width > kMostPixels || m.height > kMostPixels)
    throw std::runtime_error(fmt::format("an image of {} x {} {}, expected even numbers below {}",
                                         m.width, m.height, m.encoding, kMostPixels));
  const std::uint32_t rows = layout.planes ? m.height / 2 * 3 : m.height;
  checkBytes(m, std::uint64_t{m.width} * layout.bytes, rows);
  std::string bytes(m.data);  // those of one row need not be aligned
  if (layout.wide && m.is_bigendian != 0)
    for (std::size_t i = 1; i < bytes.size(); i += 2) std::swap(bytes[i - 1], bytes[i]);
  const bool wide = layout.wide, pairs = layout.bytes == 2 && !wide;
  cv::Mat given(static_cast<int>(rows), static_cast<int>(m.width),
                wide    ? CV_16UC1
                : pairs ? CV_8UC2
                        : CV_8UC1,
                bytes.data(), m.step);
  cv::Mat narrow, colors;
  if (wide) given.convertTo(narrow, CV_8U, 1.0 / 256, -0.5);
  cv::cvtColor(wide ? narrow : given, colors, layout.code);
  return rasterOf(colors);
}

}  // namespace

Raster rasterOf(const Image& m) {
  if (const MixedLayout* const mixed = layoutOf(mixedLayouts(), m.encoding))
    return mixedRaster(m, *mixed);
  const PixelLayout* const layout = layoutOf(pixelLayouts(), m.encoding);
  if (layout == nullptr) {
    std::vector<std::string> known;
    for (const PixelLayout& l : pixelLayouts()) known.emplace_back(l.encoding);
    for (const MixedLayout& l : mixedLayouts()) known.emplace_back(l.encoding);
    throw std::runtime_error(
        fmt::format("image encoding \"{}\", expected {}", m.encoding, fmt::join(known, ", ")));
  }
  const std::uint64_t row = std::uint64_t{m.width} * layout->bytes;
  checkBytes(m, row, m.height);
  Raster raster;
  raster.width = static_cast<int>(m.width);
  raster.height = static_cast<int>(m.height);
  raster.channels = static_cast<int>(layout->use.size());
  raster.pixels.reserve(row * m.height);
  const std::size_t swapped = layout->wide && m.is_bigendian != 0 ? 1 : 0;
  for (std::size_t y = 0; y < m.height; ++y) {
    for (std::size_t x = 0; x < m.width; ++x) {
      for (const std::size_t byte : layout->use)
        raster.pixels.push_back(
            static_cast<std::uint8_t>(m.data[y * m.step + x * layout->bytes + byte - swapped]));
    }
  }
  return raster;
}

Raster rasterOf(const CompressedImage& m) {
  cv::Mat image;
  if (!m.data.empty()) {
    const cv::Mat bytes(1, static_cast<int>(m.data.size()), CV_8U,
                        const_cast<char*>(m.data.data()));
    image = cv::imdecode(bytes, cv::IMREAD_COLOR);
  }
  if (image.empty())
    throw std::runtime_error(
        fmt::format("an image of format \"{}\" that cannot be decoded", m.format));
  return rasterOf(image);
}

}  // namespace perception::ros
