#pragma once
#include "libperception/detectors/simd/VisionKernels.h"
#include "libperception/simd/Simd.h"

namespace perception {

/// The kernels of a SIMD level, which the processor must support.
inline const VisionKernels& visionKernels(SimdLevel level) {
  return level == SimdLevel::kAvx512 ? avx512::kVisionKernels
         : level == SimdLevel::kAvx2 ? avx2::kVisionKernels
                                     : sse2::kVisionKernels;
}

}  // namespace perception
