#pragma once
#include <cstdint>
#include <optional>

namespace perception {

/// Bounds the memory of the process while it lives (RLIMIT_AS), so that hostile sizes in a torn or
/// forged rawlog end as an exception that RawlogReader reports, and not as a machine without
/// memory. MRPT's aligned allocations, whose failure MRPT 2.5.8 does not look at, throw
/// std::bad_alloc in every program that links RawlogReader.
class MemoryLimit {
 public:
  /// `bytes` 0: nine tenths of the machine's memory. No limit under address and thread sanitizers,
  /// which reserve terabytes.
  explicit MemoryLimit(std::uint64_t bytes = 0);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  static bool supported();
  /// Makes sure that the checked allocation is part of the program; does nothing else.
  static void link();

 private:
  std::optional<std::uint64_t> before_;  ///< [bytes] soft limit to go back to
};

}  // namespace perception
