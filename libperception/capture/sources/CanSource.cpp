#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "libperception/capture/sources/CanSocket.h"
#include "libperception/capture/sources/PacketSource.h"
#include "libperception/capture/sources/ReceiveControl.h"
#include "libperception/core/Error.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception {
namespace {

class CanSource final : public PacketSource {
 public:
  CanSource(const std::string& name, const std::string& interface)
      : interface_(interface), socket_(openCanSocket(interface)) {
    if (socket_ < 0)
      throw Error(ExitCode::kUnavailable,
                  fmt::format("[{}] CAN interface {}: {}", name, interface, std::strerror(errno)));
    ReceiveControl::request(socket_);
  }
  ~CanSource() override { ::close(socket_); }

  bool receive(int timeout_ms, const Take& take) override {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) return false;
    canfd_frame frame{};
    iovec part{&frame, sizeof frame};
    alignas(cmsghdr) std::array<char, ReceiveControl::kSize> control{};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    const auto count = ::recvmsg(socket_, &header, MSG_DONTWAIT);
    if (count < 0) return noteError();
    noted_ = 0;
    const Stamp at = control_.read(header);
    if (count != CAN_MTU && count != CANFD_MTU) return true;
    if ((frame.can_id & (CAN_ERR_FLAG | CAN_RTR_FLAG)) != 0) return true;
    const std::string message =
        canMessage(frame.can_id & CAN_EFF_MASK, {reinterpret_cast<const char*>(frame.data),
                                                 std::min<std::size_t>(frame.len, CANFD_MAX_DLEN)});
    take({message, at, 0});
    return true;
  }

  std::uint64_t overrun() const override { return control_.overrun(); }
  std::vector<std::string> takeEvents() override { return std::exchange(events_, {}); }

 private:
  /// Each kind once until a frame comes again: an interface that is down says so at every call.
  bool noteError() {
    if (errno == EAGAIN || errno == EINTR || errno == noted_) return false;
    noted_ = errno;
    events_.push_back(fmt::format("CAN interface {}: {}", interface_, std::strerror(noted_)));
    return false;
  }

  std::string interface_;
  int socket_;
  int noted_ = 0;
  ReceiveControl control_;
  std::vector<std::string> events_;
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
