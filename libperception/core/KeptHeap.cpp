#include "libperception/core/KeptHeap.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace perception {
namespace {

constexpr int kLargestInHeap =
    32 << 20;                         // [bytes] glibc's limit; what is larger has its own mapping
constexpr int kReserved = 256 << 20;  // [bytes] address space alone: pages come when touched
constexpr int kGrowth = 1 << 20;      // [bytes] at once, beyond the reserved ones
constexpr std::uintptr_t kHugePage = 2 << 20;

// Huge pages are of two megabytes, at multiples of it.
void askForHugePages(const void* from, const void* to) {
  const auto begin = (reinterpret_cast<std::uintptr_t>(from) + kHugePage - 1) & ~(kHugePage - 1),
             end = reinterpret_cast<std::uintptr_t>(to) & ~(kHugePage - 1);
  // A kernel without them says no, and nothing is lost.
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace

void keepFreedMemory() {
  ::mallopt(M_MMAP_THRESHOLD, kLargestInHeap);
  ::mallopt(M_TRIM_THRESHOLD, -1);  // never
  ::mallopt(M_TOP_PAD, kReserved);
  const void* const before = ::sbrk(0);
  void* volatile block = std::malloc(kLargestInHeap / 2);  // volatile: or the compiler drops both
  std::free(block);
  askForHugePages(before, ::sbrk(0));
  ::mallopt(M_TOP_PAD, kGrowth);
}

}  // namespace perception
