#define PERCEPTION_SIMD_NAMESPACE avx512
#define PERCEPTION_SIMD_LANES 8
#define PERCEPTION_SIMD_MATH(f) _ZGVeN8v_##f
#include "libperception/filter/simd/BankKernels.inl"
