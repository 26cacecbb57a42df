#define PERCEPTION_SIMD_NAMESPACE avx2
#define PERCEPTION_SIMD_LANES 8
#include "libperception/detectors/simd/VisionKernels.inl"
