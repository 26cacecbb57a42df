#pragma once
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Layout of a network's output; in the order of OnnxParams::layoutNames().
enum class OnnxLayout {
  kUnknown,
  kYolox,   ///< cells x (offset, log size, objectness, classes), strides 8, 16, 32
  kYolov5,  ///< boxes x (center, size, objectness, classes), in input pixels
  kYolov8   ///< (center, size, classes) x boxes, in input pixels
};

/// Shape of an output 1 x rows x columns.
struct OnnxShape {
  int rows = 0, columns = 0;
};

/// Layout by the shape of the output for an input of side x side pixels.
OnnxLayout guessOnnxLayout(const OnnxShape& shape, int side);
bool fitsOnnxLayout(const OnnxShape& shape, OnnxLayout layout, int side);

struct OnnxBox {
  int index = 0;                  ///< of the class
  double score = 0;               ///< [0, 1]
  ObjectDetection::ImageBox box;  ///< [px] of the input
};
/// All boxes with a best class score of at least `least`.
std::vector<OnnxBox> decodeOnnxOutput(const float* values, const OnnxShape& shape,
                                      OnnxLayout layout, int side, double least);

}  // namespace perception
