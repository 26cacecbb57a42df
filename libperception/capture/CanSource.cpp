#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "libperception/capture/CanSocket.h"
#include "libperception/capture/PacketSource.h"
#include "libperception/core/Error.h"
#include "libperception/packets/CanBundle.h"

namespace perception {
namespace {

class CanSource final : public PacketSource {
 public:
  CanSource(const std::string& name, const std::string& interface)
      : socket_(openCanSocket(interface)) {
    if (socket_ < 0)
      throw Error(ExitCode::kUnavailable,
                  fmt::format("[{}] CAN interface {}: {}", name, interface, std::strerror(errno)));
  }
  ~CanSource() override { ::close(socket_); }

  bool receive(int timeout_ms, const Take& take) override {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) return false;
    canfd_frame frame{};
    const auto count = ::recv(socket_, &frame, sizeof frame, MSG_DONTWAIT);
    if (count != CAN_MTU && count != CANFD_MTU) return false;
    if ((frame.can_id & (CAN_ERR_FLAG | CAN_RTR_FLAG)) != 0) return true;
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const std::string message =
        canMessage(frame.can_id & CAN_EFF_MASK, {reinterpret_cast<const char*>(frame.data),
                                                 std::min<std::size_t>(frame.len, CANFD_MAX_DLEN)});
    take({message,
          {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count() / 100 * 100},
          0});
    return true;
  }

 private:
  int socket_;
};

}  // namespace

int openCanSocket(const std::string& interface) {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (socket < 0) return -1;
  const int on = 1;
  ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  sockaddr_can at{};
  at.can_family = AF_CAN;
  if (::ioctl(socket, SIOCGIFINDEX, &request) == 0) {
    at.can_ifindex = request.ifr_ifindex;
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0) return socket;
  }
  const int error = errno;
  ::close(socket);
  errno = error;
  return -1;
}

std::unique_ptr<PacketSource> openCan(const std::string& name, const std::string& interface) {
  return std::make_unique<CanSource>(name, interface);
}

}  // namespace perception
