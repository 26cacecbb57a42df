#pragma once
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How a network writes its boxes; the order of OnnxParams::layoutNames().
enum class OnnxLayout {
  kUnknown,
  kYolox,   ///< cells x (offset, log size, objectness, classes), strides 8, 16, 32
  kYolov5,  ///< boxes x (center, size, objectness, classes), in input pixels
  kYolov8   ///< (center, size, classes) x boxes, in input pixels
};

/// Of an output 1 x rows x columns.
struct OnnxShape {
  int rows = 0, columns = 0;
};

/// Which layout an output of that shape can have at an input of side x side pixels.
OnnxLayout guessOnnxLayout(const OnnxShape& shape, int side);
bool fitsOnnxLayout(const OnnxShape& shape, OnnxLayout layout, int side);

struct OnnxBox {
  int index = 0;                  ///< of the class
  double score = 0;               ///< [0, 1]
  ObjectDetection::ImageBox box;  ///< [px] of the input
};
/// All boxes whose best class reaches `least`.
std::vector<OnnxBox> decodeOnnxOutput(const float* values, const OnnxShape& shape,
                                      OnnxLayout layout, int side, double least);

}  // namespace perception
