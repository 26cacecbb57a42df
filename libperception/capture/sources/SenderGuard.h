#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libperception/core/Time.h"

namespace perception {

/// Lets the packets of one sender pass, since two devices on one port would be mixed into one scan.
/// Another sender is accepted once the first one is silent.
class SenderGuard {
 public:
  static constexpr double kSilence = 1;  ///< [s]

  /// Whether the packet passes.
  bool passes(std::uint64_t sender, Stamp at);
  /// What changed with the last call, for the user.
  std::optional<std::string> takeEvent();
  std::uint64_t refused() const { return refused_; }

 private:
  std::optional<std::uint64_t> sender_, refused_sender_;
  Stamp last_;
  std::uint64_t refused_ = 0;
  std::optional<std::string> event_;
};

}  // namespace perception
