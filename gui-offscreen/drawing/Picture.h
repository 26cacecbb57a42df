#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// An RGB image in memory: rows from the top, three bytes per pixel.
struct Picture {
  int width = 0, height = 0;      ///< [px]
  std::vector<std::uint8_t> rgb;  ///< red, green, blue

  const std::uint8_t* at(int x, int y) const {
    return &rgb[static_cast<std::size_t>(y * width + x) * 3];
  }
};

/// Throws Error (kUsage) unless the name ends with .png, .jpg or .jpeg.
void requirePictureName(const std::string& path);
/// Writes a PNG or JPEG, by the ending of the name, with runMark() `mark` in it. Throws as
/// requirePictureName(), OutputError naming the path.
void writePicture(const std::string& path, const Picture& picture, const std::string& mark = "");

/// The picture as JPEG of a quality (1 to 100), made smaller if it is wider than `widest` [px].
std::string jpegOf(const Picture& picture, int widest, int quality);

struct Raster;
/// Converts a gray or color raster; empty for an empty raster.
Picture pictureOf(const Raster& raster);

}  // namespace perception
