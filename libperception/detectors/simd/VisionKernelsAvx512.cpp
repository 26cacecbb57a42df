#define PERCEPTION_SIMD_NAMESPACE avx512
#define PERCEPTION_SIMD_LANES 16
#include "libperception/detectors/simd/VisionKernels.inl"
