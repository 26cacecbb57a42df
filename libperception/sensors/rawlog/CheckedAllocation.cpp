#include "libperception/sensors/rawlog/CheckedAllocation.h"

#include <mrpt/core/aligned_allocator.h>

#include <cstdlib>
#include <new>

// MRPT's version returns null when out of memory, which its containers do not check. This
// definition overrides that of the library, whose aligned_free() is free().
void* mrpt::aligned_malloc(std::size_t size, std::size_t alignment) {
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* const memory = whole < size ? nullptr : std::aligned_alloc(alignment, whole);
  if (memory == nullptr && size > 0) throw std::bad_alloc();
  return memory;
}

namespace perception {

void linkCheckedAllocation() {}

}  // namespace perception
