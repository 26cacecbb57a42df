#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "libperception/capture/sources/PacketSource.h"
#include "libperception/capture/sources/ReceiveControl.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::size_t kDatagram = 65536, kDatagramsAtOnce = 32;
constexpr int kBuffer = 64 << 20;  ///< [bytes] asked of the kernel

class UdpSource final : public PacketSource {
 public:
  UdpSource(const std::string& name, const std::string& address, std::uint16_t port,
            const std::string& multicast)
      : bytes_(kDatagramsAtOnce * kDatagram) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    if (::inet_pton(AF_INET, address.c_str(), &at.sin_addr) != 1)
      throw ConfigError(fmt::format("[{}] {}: IPv4 address expected", name, address));
    // The privileged one is not bound by the system's limit.
    if (::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &kBuffer, sizeof kBuffer) != 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kBuffer, sizeof kBuffer);
    ReceiveControl::request(socket_);
    if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
      fail(fmt::format("[{}] UDP port {}", name, port));
    if (!multicast.empty()) join(name, multicast);
    prepare();
  }
  ~UdpSource() override { ::close(socket_); }

  bool receive(int timeout_ms, const Take& take) override {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) return false;
    for (std::size_t i = 0; i < kDatagramsAtOnce; ++i) {
      headers_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
      headers_[i].msg_hdr.msg_controllen = sizeof controls_[i];
    }
    const int count = ::recvmmsg(socket_, headers_.data(), kDatagramsAtOnce, MSG_DONTWAIT, nullptr);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      ReceivedPacket packet;
      packet.bytes = {bytes_.data() + k * kDatagram, headers_[k].msg_len};
      packet.sender = static_cast<std::uint64_t>(ntohl(senders_[k].sin_addr.s_addr)) << 16 |
                      ntohs(senders_[k].sin_port);
      packet.at = control_.read(headers_[k].msg_hdr);
      take(packet);
    }
    return count > 0;
  }

  std::uint64_t overrun() const override { return control_.overrun(); }

 private:
  [[noreturn]] void fail(const std::string& what) {
    const int error = errno;
    ::close(socket_);
    throw Error(ExitCode::kUnavailable, fmt::format("{}: {}", what, std::strerror(error)));
  }

  void join(const std::string& name, const std::string& multicast) {
    ip_mreq group{};
    if (::inet_pton(AF_INET, multicast.c_str(), &group.imr_multiaddr) != 1) {
      ::close(socket_);
      throw ConfigError(
          fmt::format("[{}] multicast = {}: an IPv4 address expected", name, multicast));
    }
    if (::setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
      fail(fmt::format("[{}] multicast {}", name, multicast));
  }

  void prepare() {
    for (std::size_t i = 0; i < kDatagramsAtOnce; ++i) {
      parts_[i] = {bytes_.data() + i * kDatagram, kDatagram};
      msghdr& header = headers_[i].msg_hdr;
      header.msg_iov = &parts_[i];
      header.msg_iovlen = 1;
      header.msg_name = &senders_[i];
      header.msg_control = controls_[i].data();
    }
  }

  int socket_ = -1;
  std::vector<char> bytes_;
  std::array<mmsghdr, kDatagramsAtOnce> headers_{};
  std::array<iovec, kDatagramsAtOnce> parts_{};
  std::array<sockaddr_in, kDatagramsAtOnce> senders_{};
  alignas(
      cmsghdr) std::array<std::array<char, ReceiveControl::kSize>, kDatagramsAtOnce> controls_{};
  ReceiveControl control_;
};

}  // namespace

std::string senderName(std::uint64_t sender) {
  return fmt::format("{}.{}.{}.{}:{}", sender >> 40 & 255, sender >> 32 & 255, sender >> 24 & 255,
                     sender >> 16 & 255, sender & 65535);
}

std::unique_ptr<PacketSource> openUdp(const std::string& name, const std::string& address,
                                      std::uint16_t port, const std::string& multicast) {
  return std::make_unique<UdpSource>(name, address, port, multicast);
}

}  // namespace perception
