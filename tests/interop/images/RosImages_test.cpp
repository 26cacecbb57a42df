// Pixels of ROS's images, as drivers of cameras send them.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "libperception/interop/ros/RosSensors.h"

namespace perception::ros {
namespace {

using Pixel = std::vector<int>;  // blue, green, red

/// The pixel in the middle of an 8 x 8 image, rows with four bytes more; within 6 of 255.
void expectMiddle(const std::string& encoding, const std::string& bytes, std::uint32_t step,
                  const Pixel& expected, bool big_endian = false) {
  SCOPED_TRACE(encoding);
  Image image;
  image.width = image.height = 8;
  image.encoding = encoding;
  image.step = step;
  image.is_bigendian = big_endian ? 1 : 0;
  image.data = bytes;
  const Raster raster = rasterOf(image);
  ASSERT_EQ(raster.width, 8);
  ASSERT_EQ(raster.height, 8);
  ASSERT_EQ(static_cast<std::size_t>(raster.channels), expected.size());
  ASSERT_EQ(raster.pixels.size(), 64 * expected.size());
  for (std::size_t c = 0; c < expected.size(); ++c)
    EXPECT_NEAR(raster.pixels[(4 * 8 + 4) * expected.size() + c], expected[c], 6) << c;
}

/// Eight rows of a unit again and again, and four bytes behind each.
std::string rowsOf(const std::string& even, const std::string& odd) {
  std::string bytes;
  for (int row = 0; row < 8; ++row) {
    const std::string& unit = row % 2 == 0 ? even : odd;
    for (std::size_t x = 0; x < 8; x += 2) bytes += unit;
    bytes += "pad.";
  }
  return bytes;
}

TEST(RosImages, BayerPatternsGiveTheirColors) {
  // A surface of red 200, green 100, blue 30.
  const std::string r = "\xC8", g = "\x64", b = "\x1E";
  const Pixel color = {30, 100, 200};
  expectMiddle("bayer_rggb8", rowsOf(r + g, g + b), 12, color);
  expectMiddle("bayer_bggr8", rowsOf(b + g, g + r), 12, color);
  expectMiddle("bayer_gbrg8", rowsOf(g + b, r + g), 12, color);
  expectMiddle("bayer_grbg8", rowsOf(g + r, b + g), 12, color);
  const std::string low = "\x7F";
  expectMiddle("bayer_rggb16", rowsOf(low + r + low + g, low + g + low + b), 20, color);
  expectMiddle("bayer_rggb16", rowsOf(r + low + g + low, g + low + b + low), 20, color, true);
}

TEST(RosImages, FormsOfYuvGiveTheirColors) {
  // Luminance 120, and as much red as makes its difference 40 (ITU-R BT.601).
  const std::string y = "\x78", u = "\x80", v = "\xA8";
  const Pixel reddish = {121, 88, 185};
  expectMiddle("yuv422", rowsOf(u + y + v + y, u + y + v + y), 20, reddish);
  expectMiddle("uyvy", rowsOf(u + y + v + y, u + y + v + y), 20, reddish);
  expectMiddle("yuv422_yuy2", rowsOf(y + u + y + v, y + u + y + v), 20, reddish);
  expectMiddle("yuyv", rowsOf(y + u + y + v, y + u + y + v), 20, reddish);
  std::string planes(64, '\x78'), nv21 = planes;
  for (int i = 0; i < 16; ++i) planes += u + v, nv21 += v + u;
  expectMiddle("nv12", planes, 8, reddish);
  expectMiddle("nv21", nv21, 8, reddish);
}

TEST(RosImages, ValuesOfTwoBytesGiveTheHigherOneInBothOrders) {
  std::string little, big;
  for (int i = 0; i < 64; ++i) little += "\x11\x50", big += "\x50\x11";
  expectMiddle("mono16", little, 16, {0x50});
  expectMiddle("mono16", big, 16, {0x50}, true);
  std::string colors;
  for (int i = 0; i < 64; ++i) colors += std::string("\0\x50\0\x60\0\x70", 6);
  expectMiddle("rgb16", colors, 48, {0x70, 0x60, 0x50});
}

TEST(RosImages, TooFewBytesAndUnknownEncodingsAreRefused) {
  Image image;
  image.width = image.height = 8;
  image.step = 8;
  const std::string bytes(64, '\1');
  image.data = bytes;
  image.encoding = "nv12";  // needs twelve rows
  EXPECT_THROW(rasterOf(image), std::runtime_error);
  image.encoding = "bayer_rggb8";
  image.width = 7;
  EXPECT_THROW(rasterOf(image), std::runtime_error);
  image.encoding = "32FC1";
  try {
    rasterOf(image);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("bayer_rggb8"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace perception::ros
