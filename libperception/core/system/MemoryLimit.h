#pragma once
#include <cstdint>
#include <optional>

namespace perception {

/// Limits the memory of the process (RLIMIT_AS) during its lifetime, so that implausible sizes in a
/// truncated or forged file cause an exception where it is read instead of exhausting the machine.
class MemoryLimit {
 public:
  /// `bytes` 0: nine tenths of the machine's memory. No limit under address and thread sanitizers,
  /// which reserve terabytes.
  explicit MemoryLimit(std::uint64_t bytes = 0);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  static bool supported();

 private:
  std::optional<std::uint64_t> before_;  ///< [bytes] former soft limit
};

/// [bytes] of the process, as RLIMIT_AS counts them; 0 if unknown.
std::uint64_t addressSpace();

}  // namespace perception
