#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "libperception/detectors/DpmOptions.h"
#include "libperception/detectors/GroundGate.h"
#include "libperception/detectors/dpm/DpmModel.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simd/Simd.h"

namespace perception {

struct DpmBank;

/// One model with its threshold.
struct DpmTarget {
  DpmModel model;
  double threshold = -1;       ///< least score of a detection (assumed)
  double low = 0.5, high = 3;  ///< [m] heights of the objects on the ground (assumed)
};

/// A detection of a model.
struct DpmDetection {
  int target = 0, component = 0;
  double score = 0;
  ObjectDetection::ImageBox box;  ///< [px] may extend beyond the image
  std::optional<double> heading;  ///< [rad] KITTI's alpha, interpolated between components
};

/// Detects deformable part models in images: all components of all classes on one feature pyramid,
/// parts convolved exactly by Fourier transform of 16 x 16 patches [dubout2012], only where the
/// ground allows objects (method.md 8.8). The result does not depend on the number of threads.
class DpmEngine {
 public:
  DpmEngine(std::vector<DpmTarget> targets, DpmOptions options, SimdLevel level = simdLevel());
  ~DpmEngine();
  DpmEngine(DpmEngine&&) noexcept;

  /// One box per object and target, best first.
  std::vector<DpmDetection> detect(const Raster& image, const SearchRegion& region = {}) const;
  /// All detections at or above the thresholds, before suppression.
  std::vector<DpmDetection> places(const Raster& image, const SearchRegion& region = {}) const;
  const std::vector<DpmTarget>& targets() const;

 private:
  std::unique_ptr<const DpmBank> bank_;
};

}  // namespace perception
