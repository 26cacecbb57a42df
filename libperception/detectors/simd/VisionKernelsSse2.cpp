#define PERCEPTION_SIMD_NAMESPACE sse2
#define PERCEPTION_SIMD_LANES 4
#include "libperception/detectors/simd/VisionKernels.inl"
