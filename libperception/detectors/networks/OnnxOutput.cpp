#include "libperception/detectors/networks/OnnxOutput.h"

#include <cmath>

namespace perception {
namespace {

constexpr int kStrides[] = {8, 16, 32};

int cellsOf(int side) {
  int n = 0;
  for (const int stride : kStrides) n += (side / stride) * (side / stride);
  return n;
}

/// Position, size and scores of one box as in the output.
struct Raw {
  double x, y, width, height;
};

ObjectDetection::ImageBox boxOf(const Raw& r) {
  return {r.x - 0.5 * r.width, r.y - 0.5 * r.height, r.x + 0.5 * r.width, r.y + 0.5 * r.height};
}

/// Decodes entry `i` of YOLOX, ordered by stride, row and column.
Raw fromCell(const Raw& r, int i, int side) {
  for (const int stride : kStrides) {
    const int cells = side / stride;
    if (i < cells * cells)
      return {(r.x + i % cells) * stride, (r.y + i / cells) * stride, std::exp(r.width) * stride,
              std::exp(r.height) * stride};
    i -= cells * cells;
  }
  return r;
}

}  // namespace

OnnxLayout guessOnnxLayout(const OnnxShape& shape, int side) {
  for (const OnnxLayout layout : {OnnxLayout::kYolox, OnnxLayout::kYolov5, OnnxLayout::kYolov8}) {
    if (fitsOnnxLayout(shape, layout, side)) return layout;
  }
  return OnnxLayout::kUnknown;
}

bool fitsOnnxLayout(const OnnxShape& shape, OnnxLayout layout, int side) {
  switch (layout) {
    case OnnxLayout::kYolox:
      return shape.rows == cellsOf(side) && shape.columns >= 6;
    case OnnxLayout::kYolov5:
      // Three anchors per cell; other strides change the number of boxes, but there are more boxes
      // than values.
      return shape.rows > shape.columns && shape.rows != cellsOf(side) && shape.columns >= 6;
    case OnnxLayout::kYolov8:
      return shape.columns > shape.rows && shape.rows >= 5;
    case OnnxLayout::kUnknown:
      break;
  }
  return false;
}

std::vector<OnnxBox> decodeOnnxOutput(const float* values, const OnnxShape& shape,
                                      OnnxLayout layout, int side, double least) {
  const bool by_box = layout != OnnxLayout::kYolov8;
  const int boxes = by_box ? shape.rows : shape.columns;
  const int numbers = by_box ? shape.columns : shape.rows;
  const int first_class = by_box ? 5 : 4;
  std::vector<OnnxBox> out;
  for (int i = 0; i < boxes; ++i) {
    const auto value = [&](int k) {
      return static_cast<double>(
          values[by_box ? static_cast<long>(i) * numbers + k : static_cast<long>(k) * boxes + i]);
    };
    OnnxBox box;
    for (int k = first_class; k < numbers; ++k) {
      if (k == first_class || value(k) > box.score)
        box.score = value(k), box.index = k - first_class;
    }
    if (by_box) box.score *= value(4);
    if (!(box.score >= least)) continue;
    Raw raw{value(0), value(1), value(2), value(3)};
    if (layout == OnnxLayout::kYolox) raw = fromCell(raw, i, side);
    if (!std::isfinite(raw.x + raw.y + raw.width + raw.height)) continue;
    box.box = boxOf(raw);
    out.push_back(box);
  }
  return out;
}

}  // namespace perception
