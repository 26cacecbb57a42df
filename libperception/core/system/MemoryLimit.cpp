#include "libperception/core/system/MemoryLimit.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace perception {

namespace {

constexpr std::uint64_t kLeast = 2ULL << 30;  // [bytes] half of it is reserved by libraries

std::uint64_t machineMemory() {
  const auto pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0
             ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size)
             : 0;
}

}  // namespace

std::uint64_t addressSpace() {
  static const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  char text[64] = {};
  if (file < 0 || ::pread(file, text, sizeof text - 1, 0) <= 0) return 0;
  return std::strtoull(text, nullptr, 10) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

bool MemoryLimit::supported() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

MemoryLimit::MemoryLimit(std::uint64_t bytes) {
  if (!supported()) return;
  const std::uint64_t memory = machineMemory();
  if (bytes == 0 && memory == 0) return;
  if (bytes == 0) bytes = std::max(kLeast, memory / 10 * 9);
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur <= bytes) return;
  before_ = limit.rlim_cur;
  limit.rlim_cur = bytes;
  if (::setrlimit(RLIMIT_AS, &limit) != 0) before_.reset();
}

MemoryLimit::~MemoryLimit() {
  struct rlimit limit {};
  if (!before_ || ::getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = *before_;
  ::setrlimit(RLIMIT_AS, &limit);
}

}  // namespace perception
