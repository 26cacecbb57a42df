#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "libperception/capture/sources/PacketSource.h"
#include "libperception/core/Error.h"
#include "libperception/packets/lidars/Ibeo.h"

namespace perception {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kAtOnce = 1 << 18;
constexpr auto kAgain = milliseconds(500);  ///< between two attempts to connect
constexpr int kConnectMs = 200;

class IbeoTcpSource final : public PacketSource {
 public:
  IbeoTcpSource(const std::string& name, const std::string& host, std::uint16_t port)
      : server_(fmt::format("{}:{}", host, port)), bytes_(kAtOnce) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(port);
    if (::inet_pton(AF_INET, host.c_str(), &to_.sin_addr) != 1)
      throw ConfigError(fmt::format("[{}] host '{}': IPv4 address expected", name, host));
  }
  ~IbeoTcpSource() override { disconnect(); }

  bool receive(int timeout_ms, const Take& take) override {
    if (socket_ < 0 && !connect()) {
      std::this_thread::sleep_for(milliseconds(std::min(timeout_ms, 20)));
      return false;
    }
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) return false;
    const auto count = ::recv(socket_, bytes_.data(), bytes_.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
    if (count <= 0) {
      events_.push_back(fmt::format("the connection to {} ended", server_));
      disconnect();
      return false;
    }
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const Stamp now{std::chrono::duration_cast<std::chrono::nanoseconds>(since).count() / 100 *
                    100};
    for (const std::string& message : stream_.add({bytes_.data(), static_cast<std::size_t>(count)}))
      take({message, now, 0});
    if (stream_.skipped() > skipped_)
      events_.push_back(fmt::format("{} bytes belong to no message", stream_.skipped() - skipped_));
    skipped_ = stream_.skipped();
    return true;
  }

  std::vector<std::string> takeEvents() override { return std::exchange(events_, {}); }

 private:
  bool connect() {
    const auto now = steady_clock::now();
    if (now < next_) return false;
    next_ = now + kAgain;
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    bool good = socket >= 0;
    if (good && ::connect(socket, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) != 0) {
      pollfd wait{socket, POLLOUT, 0};
      int error = 0;
      socklen_t size = sizeof error;
      good = errno == EINPROGRESS && ::poll(&wait, 1, kConnectMs) == 1 &&
             ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
    }
    if (!good) {
      if (socket >= 0) ::close(socket);
      if (!std::exchange(absent_, true))
        events_.push_back(fmt::format("{} does not answer", server_));
      return false;
    }
    noticeSilence(socket);
    if (absent_) events_.push_back(fmt::format("connected to {}", server_));
    absent_ = false;
    socket_ = socket;
    return true;
  }

  /// A device without power does not close its connection: the kernel asks it after a silence of
  /// three seconds, and two more, and then ends it.
  static void noticeSilence(int socket) {
    const int on = 1, idle = 3, again = 1, times = 2;
    ::setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &idle, sizeof idle);
    ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &again, sizeof again);
    ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &times, sizeof times);
  }

  void disconnect() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    absent_ = true;
    stream_ = {};
    skipped_ = 0;
  }

  std::string server_;
  std::vector<char> bytes_;
  sockaddr_in to_{};
  int socket_ = -1;
  bool absent_ = false;
  steady_clock::time_point next_{};
  IbeoStream stream_;
  std::uint64_t skipped_ = 0;
  std::vector<std::string> events_;
};

}  // namespace

std::unique_ptr<PacketSource> openIbeoTcp(const std::string& name, const std::string& host,
                                          std::uint16_t port) {
  return std::make_unique<IbeoTcpSource>(name, host, port);
}

}  // namespace perception
