#pragma once

namespace perception {

/// How wide the arithmetic of a batch is. Chosen at run time; results may differ in their
/// last digits between levels.
enum class SimdLevel { kSse2, kAvx2, kAvx512 };
/// The widest that this processor has. The environment variable PERCEPTION_SIMD (sse2, avx2,
/// avx512) lowers it.
SimdLevel simdLevel();
const char* nameOf(SimdLevel level);

}  // namespace perception
