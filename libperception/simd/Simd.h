#pragma once

namespace perception {

/// Register width of batch arithmetic, selected at run time. Results may differ in their last
/// digits between levels.
enum class SimdLevel { kSse2, kAvx2, kAvx512 };
/// The widest level of this processor. The environment variable PERCEPTION_SIMD (sse2, avx2,
/// avx512) lowers it.
SimdLevel simdLevel();
const char* nameOf(SimdLevel level);

}  // namespace perception
