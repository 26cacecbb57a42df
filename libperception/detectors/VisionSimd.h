#pragma once
#include "libperception/detectors/simd/VisionKernels.h"
#include "libperception/simd/Simd.h"

namespace perception {

/// The inner loops for a level that this processor has.
inline const VisionKernels& visionKernels(SimdLevel level) {
  return level == SimdLevel::kAvx512 ? avx512::kVisionKernels
         : level == SimdLevel::kAvx2 ? avx2::kVisionKernels
                                     : sse2::kVisionKernels;
}

}  // namespace perception
