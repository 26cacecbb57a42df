#pragma once
#include "libperception/core/Simd.h"
#include "libperception/vision/simd/VisionKernels.h"

namespace perception {

/// The inner loops for a level that this processor has.
inline const VisionKernels& visionKernels(SimdLevel level) {
  return level == SimdLevel::kAvx512 ? avx512::kVisionKernels
         : level == SimdLevel::kAvx2 ? avx2::kVisionKernels
                                     : sse2::kVisionKernels;
}

}  // namespace perception
