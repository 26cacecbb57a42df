#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace perception::test {

/// A client that sends any bytes, by sockets alone: servers are tried with what no library sends.
class RawClient {
 public:
  explicit RawClient(std::uint16_t port, int receive_buffer = 0)
      : file_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval limit{10, 0};
    ::setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(file_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    if (receive_buffer > 0)
      ::setsockopt(file_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(file_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
      throw std::runtime_error("no connection");
  }
  ~RawClient() { ::close(file_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void send(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const auto sent = ::send(file_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return;  // the server has closed
      at += static_cast<std::size_t>(sent);
    }
  }
  /// Up to and with `end`; what there is when the server closes or is silent.
  std::string readTo(const std::string& end) {
    std::string text;
    while (text.size() < end.size() ||
           text.compare(text.size() - end.size(), end.size(), end) != 0) {
      const auto byte = next();
      if (!byte) break;
      text += *byte;
    }
    return text;
  }
  std::string readAll() {
    std::string text;
    while (const auto byte = next()) text += *byte;
    return text;
  }
  std::string read(std::size_t count) {
    std::string text;
    while (text.size() < count) {
      const auto byte = next();
      if (!byte) break;
      text += *byte;
    }
    return text;
  }

 private:
  std::optional<char> next() {
    if (at_ == unread_.size()) {
      unread_.resize(65536);
      const auto got = ::recv(file_, unread_.data(), unread_.size(), 0);
      unread_.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
      at_ = 0;
      if (unread_.empty()) return std::nullopt;
    }
    return unread_[at_++];
  }

  int file_;
  std::string unread_;
  std::size_t at_ = 0;
};

/// The answer to a request, whole.
inline std::string answerTo(std::uint16_t port, const std::string& request) {
  RawClient client(port);
  client.send(request);
  return client.readAll();
}

inline std::string hostLine(std::uint16_t port) {
  return "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
}

inline std::string getRequest(std::uint16_t port, const std::string& target,
                              const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\n" + hostLine(port) + more + "\r\n";
}

/// A frame of RFC 6455 section 5.2 from a client; `length`: as said, whatever follows.
inline std::string frameOf(int opcode, const std::string& payload, bool masked = true,
                           std::optional<std::uint64_t> length = std::nullopt) {
  const std::uint64_t n = length.value_or(payload.size());
  std::string bytes(1, static_cast<char>(0x80 | opcode));
  const int mask = masked ? 0x80 : 0;
  const int size_bytes = n < 126 ? 0 : n < 65536 ? 2 : 8;
  bytes += static_cast<char>(mask | (size_bytes == 0   ? static_cast<int>(n)
                                     : size_bytes == 2 ? 126
                                                       : 127));
  for (int i = size_bytes - 1; i >= 0; --i) bytes += static_cast<char>(n >> (8 * i) & 255);
  if (masked) bytes += std::string(4, '\0');  // a mask of zeros changes nothing
  return bytes + payload;
}

/// A client of a WebSocket.
class SocketClient : public RawClient {
 public:
  struct Frame {
    int opcode = 0;
    std::string payload;
    /// Of a frame that closes.
    int code() const {
      return payload.size() < 2 ? 0
                                : static_cast<unsigned char>(payload[0]) * 256 +
                                      static_cast<unsigned char>(payload[1]);
    }
  };

  SocketClient(std::uint16_t port, const std::string& protocol, const std::string& more = "",
               const std::string& target = "/", int receive_buffer = 0)
      : RawClient(port, receive_buffer) {
    send(getRequest(port, target,
                    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
                        protocol + "\r\n" + more));
    answer = readTo("\r\n\r\n");
  }
  bool isOpen() const { return answer.rfind("HTTP/1.1 101", 0) == 0; }

  /// Empty when the server closes or is silent.
  std::optional<Frame> frame() {
    const std::string head = read(2);
    if (head.size() < 2) return std::nullopt;
    std::uint64_t n = static_cast<unsigned char>(head[1]) & 127;
    if (n >= 126) {
      const std::string size = read(n == 126 ? 2 : 8);
      n = 0;
      for (const char c : size) n = n << 8 | static_cast<unsigned char>(c);
    }
    return Frame{static_cast<unsigned char>(head[0]) & 15, read(n)};
  }
  /// The next frame that is no ping.
  std::optional<Frame> message() {
    auto got = frame();
    while (got && got->opcode == 9) got = frame();
    return got;
  }
  void say(const std::string& text) { send(frameOf(1, text)); }

  std::string answer;  ///< head of the handshake
};

}  // namespace perception::test
