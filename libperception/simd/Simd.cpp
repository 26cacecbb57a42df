#include "libperception/simd/Simd.h"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace perception {
namespace {

SimdLevel widest() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return SimdLevel::kAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return SimdLevel::kAvx2;
  return SimdLevel::kSse2;
}

SimdLevel chosen() {
  const char* wish = std::getenv("PERCEPTION_SIMD");
  const std::string name = wish ? wish : "";
  SimdLevel level = widest();
  if (name == "sse2") level = SimdLevel::kSse2;
  if (name == "avx2") level = std::min(level, SimdLevel::kAvx2);
  return level;
}

}  // namespace

SimdLevel simdLevel() {
  static const SimdLevel level = chosen();
  return level;
}

const char* nameOf(SimdLevel level) {
  return level == SimdLevel::kSse2 ? "sse2" : level == SimdLevel::kAvx2 ? "avx2" : "avx512";
}

}  // namespace perception
