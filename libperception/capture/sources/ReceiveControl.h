#pragma once
#include <sys/socket.h>

#include <cstdint>

#include "libperception/core/Time.h"

namespace perception {

/// What the kernel reports about a socket's messages besides their bytes: when each arrived, and
/// how many were lost because it had no room for them.
class ReceiveControl {
 public:
  /// [bytes] that recvmsg's control buffer needs.
  static constexpr std::size_t kSize = 128;

  /// Asks the kernel for both.
  static void request(int socket);
  /// Reads the control data of a message; returns its reception, in steps of 100 ns (MRPT's), of
  /// this computer's clock where the kernel does not tell.
  Stamp read(const msghdr& message);
  /// Messages left out since the socket was opened, up to the last one read.
  std::uint64_t overrun() const { return overrun_; }

 private:
  std::uint64_t overrun_ = 0;
};

}  // namespace perception
