#include "libperception/core/system/KeptHeap.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace perception {
namespace {

constexpr int kLargestInHeap =
    32 << 20;                         // [bytes] glibc's limit; what is larger has its own mapping
constexpr int kReserved = 256 << 20;  // [bytes] address space alone: pages come when touched
constexpr int kGrowth = 1 << 20;      // [bytes] at once, beyond the reserved ones
constexpr std::size_t kHugePage = 2 << 20;

// Huge pages are of two megabytes, at multiples of it.
void askForHugePages(void* from, const void* to) {
  auto size = static_cast<std::size_t>(static_cast<const char*>(to) - static_cast<char*>(from));
  // A kernel without them says no, and nothing is lost.
  if (std::align(kHugePage, kHugePage, from, size))
    ::madvise(from, size / kHugePage * kHugePage, MADV_HUGEPAGE);
}

}  // namespace

void keepFreedMemory() {
  ::mallopt(M_MMAP_THRESHOLD, kLargestInHeap);
  ::mallopt(M_TRIM_THRESHOLD, -1);  // never
  ::mallopt(M_TOP_PAD, kReserved);
  void* const before = ::sbrk(0);
  void* volatile block = std::malloc(kLargestInHeap / 2);  // volatile: or the compiler drops both
  std::free(block);
  askForHugePages(before, ::sbrk(0));
  ::mallopt(M_TOP_PAD, kGrowth);
}

}  // namespace perception
