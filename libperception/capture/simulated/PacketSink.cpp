#include "libperception/capture/simulated/PacketSink.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <linux/can.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "libperception/capture/sources/CanSocket.h"
#include "libperception/core/Error.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception {
namespace {

constexpr int kWaitMs = 50;

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return at;
}

[[noreturn]] void unavailable(const std::string& what) {
  throw Error(ExitCode::kUnavailable, fmt::format("{}: {}", what, std::strerror(errno)));
}

class UdpSink final : public PacketSink {
 public:
  explicit UdpSink(std::uint16_t port)
      : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), to_(loopback(port)) {}
  ~UdpSink() override { ::close(socket_); }
  bool ready(const std::atomic<bool>&) override { return socket_ >= 0; }
  bool send(const std::string& payload) override {
    return ::sendto(socket_, payload.data(), payload.size(), 0,
                    reinterpret_cast<const sockaddr*>(&to_),
                    sizeof to_) == static_cast<ssize_t>(payload.size());
  }

 private:
  int socket_;
  sockaddr_in to_;
};

class TcpSink final : public PacketSink {
 public:
  explicit TcpSink(std::uint16_t port) : server_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int on = 1;
    ::setsockopt(server_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    const sockaddr_in at = loopback(port);
    if (server_ >= 0 && ::bind(server_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0 &&
        ::listen(server_, 1) == 0)
      return;
    const int error = errno;
    if (server_ >= 0) ::close(server_);
    errno = error;
    unavailable(fmt::format("TCP port {} of a simulated device", port));
  }
  ~TcpSink() override {
    if (client_ >= 0) ::close(client_);
    ::close(server_);
  }

  bool ready(const std::atomic<bool>& stop) override {
    while (client_ < 0 && !stop) {
      pollfd wait{server_, POLLIN, 0};
      if (::poll(&wait, 1, kWaitMs) > 0) client_ = ::accept(server_, nullptr, nullptr);
    }
    return client_ >= 0;
  }

  bool send(const std::string& payload) override {
    for (std::size_t sent = 0; sent < payload.size();) {
      const auto count =
          ::send(client_, payload.data() + sent, payload.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      sent += static_cast<std::size_t>(count);
    }
    return true;
  }

 private:
  int server_, client_ = -1;
};

class CanSink final : public PacketSink {
 public:
  explicit CanSink(const std::string& interface) {
    // Not on the bus of a vehicle.
    if (interface.rfind("vcan", 0) != 0)
      throw ConfigError("a simulated device sends on virtual interfaces (vcan0) alone, not on " +
                        interface);
    socket_ = openCanSocket(interface);
    if (socket_ < 0) unavailable("CAN interface " + interface + " of a simulated device");
  }
  ~CanSink() override { ::close(socket_); }
  bool ready(const std::atomic<bool>&) override { return true; }
  bool send(const std::string& message) override {
    if (message.size() < 4 || message.size() > 4 + CANFD_MAX_DLEN) return false;
    canfd_frame frame{};
    const std::uint32_t id = canId(message);
    frame.can_id = id > CAN_SFF_MASK ? id | CAN_EFF_FLAG : id;
    frame.len = static_cast<std::uint8_t>(message.size() - 4);
    std::memcpy(frame.data, message.data() + 4, frame.len);
    const std::size_t size = frame.len > CAN_MAX_DLEN ? CANFD_MTU : CAN_MTU;
    return ::write(socket_, &frame, size) == static_cast<ssize_t>(size);
  }

 private:
  int socket_ = -1;
};

}  // namespace

std::unique_ptr<PacketSink> loopbackUdp(std::uint16_t port) {
  return std::make_unique<UdpSink>(port);
}
std::unique_ptr<PacketSink> loopbackTcp(std::uint16_t port) {
  return std::make_unique<TcpSink>(port);
}
std::unique_ptr<PacketSink> canSink(const std::string& interface) {
  return std::make_unique<CanSink>(interface);
}

}  // namespace perception
