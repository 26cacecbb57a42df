#define PERCEPTION_SIMD_NAMESPACE sse2
#define PERCEPTION_SIMD_LANES 2
#define PERCEPTION_SIMD_MATH(f) _ZGVbN2v_##f
#include "libperception/filter/simd/BankKernels.inl"
