// find_people INI IMAGE: prints the boxes that a detector of images finds.
#include <mrpt/img/CImage.h>

#include <cstdio>
#include <exception>

#include "libperception/config/ShippedFiles.h"
#include "libperception/detectors/ImageDetector.h"

using namespace perception;

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: find_people INI IMAGE\n", stderr), 64;
  Config config = Config::fromFile(foundOrShipped(argv[1], argv[1]));
  const ImageDetector detector(DetectorSetup::read(config));

  mrpt::img::CImage file;
  if (!file.loadFromFile(argv[2])) return std::fprintf(stderr, "%s: no image\n", argv[2]), 66;
  Raster image{int(file.getWidth()), int(file.getHeight()), file.isColor() ? 3 : 1, {}};
  for (int row = 0; row < image.height; ++row) {
    const auto* line = file.ptrLine<std::uint8_t>(unsigned(row));
    image.pixels.insert(image.pixels.end(), line, line + image.width * image.channels);
  }
  CameraModel camera;  // unknown focal length: the whole image is searched
  camera.width = image.width;
  camera.height = image.height;

  const auto found = detector.detect(image, camera, std::nullopt).objects;
  for (const ObjectDetection& object : found) {
    const auto& box = *object.image_box;
    std::printf("%s, score %.2f: (%.0f, %.0f) to (%.0f, %.0f) px\n", object.label.c_str(),
                object.score, box.x1, box.y1, box.x2, box.y2);
  }
  std::printf("%zu boxes\n", found.size());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "find_people: error: %s\n", error.what()), 65;
}
