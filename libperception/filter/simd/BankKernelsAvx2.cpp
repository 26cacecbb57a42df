#define PERCEPTION_SIMD_NAMESPACE avx2
#define PERCEPTION_SIMD_LANES 4
#define PERCEPTION_SIMD_MATH(f) _ZGVdN4v_##f
#include "libperception/filter/simd/BankKernels.inl"
