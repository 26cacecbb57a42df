#pragma once
#include <vector>

#include "libperception/detectors/AlignedFloats.h"
#include "libperception/detectors/simd/VisionKernels.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A range of rows or columns, end excluded.
struct Span {
  int begin = 0, end = 0;
  bool empty() const { return end <= begin; }
  int size() const { return empty() ? 0 : end - begin; }
  /// The smallest range that contains both.
  Span with(const Span& other) const;
  Span within(const Span& limits) const;
};

/// Rows `rows` of an image of width x height pixels, in three planes of floats.
struct PlanarImage {
  int width = 0, height = 0;  ///< [px] of the whole image
  Span rows;                  ///< [px] stored rows
  long stride = 0;            ///< [floats] of a row of one channel
  AlignedFloats values;       ///< row by row, each as blue, green, red

  PixelRow row(int y) const;
  float* channel(int y, int c) {
    return values.data() + (static_cast<long>(y - rows.begin) * 3 + c) * stride;
  }
  const float* channel(int y, int c) const {
    return values.data() + (static_cast<long>(y - rows.begin) * 3 + c) * stride;
  }
};

PlanarImage planarImage(const Raster& image);
/// The whole image at half its size (means of two by two pixels).
PlanarImage halved(const PlanarImage& image);
/// Rows `rows` of the image at width x height: means over areas when smaller, linear when larger.
PlanarImage resampled(const PlanarImage& image, int width, int height, Span rows,
                      const VisionKernels& kernels);

/// HOG features of a grid of cells; cell 0 begins at the image's corner. Cells without features
/// (the outermost ones of the image and those beyond) are 0 except for the last value, 1.
struct FeatureMap {
  Span x, y;             ///< [cells] that are stored, beyond the image too
  AlignedFloats values;  ///< kHogFeatures per cell, row by row

  long rowStride() const { return static_cast<long>(x.size()) * kHogFeatures; }
  const float* cell(int column, int row) const {
    return values.data() + (row - y.begin) * rowStride() +
           static_cast<long>(column - x.begin) * kHogFeatures;
  }
  float* cell(int column, int row) {
    return values.data() + (row - y.begin) * rowStride() +
           static_cast<long>(column - x.begin) * kHogFeatures;
  }
};

/// Cells of `side` pixels across `pixels` (voc-release: rounded).
int cellsAcross(int pixels, int side);
/// Pixel rows that are read for features of cell rows `cells`.
Span pixelRows(Span cells, int side, int height);

/// A requested feature map: side of its cells and region.
struct FeatureRequest {
  int side = 8;  ///< [px]
  Span x, y;     ///< [cells]
};
/// Feature maps of several cell sides from common gradients. The image must hold the pixelRows() of
/// each.
std::vector<FeatureMap> hogFeatures(const PlanarImage& image,
                                    const std::vector<FeatureRequest>& requests,
                                    const VisionKernels& kernels);

}  // namespace perception
