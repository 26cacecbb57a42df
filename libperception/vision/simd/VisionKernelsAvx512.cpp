#define PERCEPTION_SIMD_NAMESPACE avx512
#define PERCEPTION_SIMD_LANES 16
#include "libperception/vision/simd/VisionKernels.inl"
