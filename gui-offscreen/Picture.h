#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// A color picture in memory: rows from the top, three bytes a pixel.
struct Picture {
  int width = 0, height = 0;      ///< [px]
  std::vector<std::uint8_t> rgb;  ///< red, green, blue

  const std::uint8_t* at(int x, int y) const {
    return &rgb[static_cast<std::size_t>(y * width + x) * 3];
  }
};

/// Number of different colors; 1 = blank.
std::size_t colorsOf(const Picture& picture);

/// Writes a PNG. Throws OutputError naming the path.
void writePng(const std::string& path, const Picture& picture);

struct Raster;
/// Gray or color, without a transparency; empty for an image that is none.
Picture pictureOf(const Raster& raster);

}  // namespace perception
