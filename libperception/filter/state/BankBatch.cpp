#include "libperception/filter/state/BankBatch.h"

#include <algorithm>
#include <cstdint>

#define PERCEPTION_DECLARE_KERNELS(level)                                                     \
  namespace level {                                                                           \
  void predictConstantVelocity(unsigned long n, unsigned long s, const double* m, double* b); \
  void predictWheeled(unsigned long n, unsigned long s, const double* m, double* b);          \
  void predictMoments(unsigned long n, unsigned long s, const double* m, double* b);          \
  }

namespace perception {

PERCEPTION_DECLARE_KERNELS(sse2)
PERCEPTION_DECLARE_KERNELS(avx2)
PERCEPTION_DECLARE_KERNELS(avx512)

namespace {

constexpr std::size_t kVector = 8;  // doubles of the widest register

std::size_t countOf(const BatchPart& part, const Planes& planes) {
  return std::min(part.end, planes.size()) - part.first;
}

}  // namespace

Planes::Planes(std::size_t size, std::size_t planes)
    : size_(size),
      padded_((size + kVector - 1) / kVector * kVector),
      values_(planes * padded_ + kVector, 0.0) {
  const auto address = reinterpret_cast<std::uintptr_t>(values_.data());
  constexpr std::uintptr_t kBytes = kVector * sizeof(double);
  offset_ = ((kBytes - address % kBytes) % kBytes) / sizeof(double);
}

void predictConstantVelocity(const MotionBatch& motion, BankBatch& bank, SimdLevel level,
                             BatchPart part) {
  const auto kernel = level == SimdLevel::kAvx512 ? avx512::predictConstantVelocity
                      : level == SimdLevel::kAvx2 ? avx2::predictConstantVelocity
                                                  : sse2::predictConstantVelocity;
  kernel(countOf(part, bank), bank.padded(), motion[0] + part.first, bank[0] + part.first);
}

void predictWheeled(const MotionBatch& motion, BankBatch& bank, SimdLevel level, BatchPart part) {
  const auto kernel = level == SimdLevel::kAvx512 ? avx512::predictWheeled
                      : level == SimdLevel::kAvx2 ? avx2::predictWheeled
                                                  : sse2::predictWheeled;
  kernel(countOf(part, bank), bank.padded(), motion[0] + part.first, bank[0] + part.first);
}

void predictMoments(const MotionBatch& motion, BankBatch& bank, SimdLevel level, BatchPart part) {
  const auto kernel = level == SimdLevel::kAvx512 ? avx512::predictMoments
                      : level == SimdLevel::kAvx2 ? avx2::predictMoments
                                                  : sse2::predictMoments;
  kernel(countOf(part, bank), bank.padded(), motion[0] + part.first, bank[0] + part.first);
}

}  // namespace perception
