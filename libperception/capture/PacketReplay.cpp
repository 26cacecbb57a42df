#include "libperception/capture/PacketReplay.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <random>

#include "libperception/core/Error.h"
#include "libperception/packets/Pcap.h"

namespace perception {

PacketReplay::PacketReplay(const ReplayParams& params) : params_(params) {
  const PcapContents contents = readPcap(params.pcap);
  std::int64_t first = 0;
  for (const UdpPacket& udp : contents.packets) {
    if (udp.port != params.from_port) continue;
    if (packets_.empty()) first = udp.stamp_ns;
    packets_.push_back({static_cast<double>(udp.stamp_ns - first) * 1e-9, udp.payload});
  }
  if (packets_.empty())
    throw DataError(params.pcap + ": no packet to port " + std::to_string(params.from_port));
}

PacketReplay::~PacketReplay() { stop(); }

void PacketReplay::start() {
  thread_ = std::thread([this] { run(); });
}

void PacketReplay::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

SentLedger PacketReplay::ledger() const { return ledger_; }

void PacketReplay::send(int socket, const std::string& payload) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(params_.to_port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto count = ::sendto(socket, payload.data(), payload.size(), 0,
                              reinterpret_cast<const sockaddr*>(&to), sizeof to);
  if (count == static_cast<ssize_t>(payload.size())) ++ledger_.sent;
}

void PacketReplay::run() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::mt19937_64 random(params_.seed);
  const auto happens = [&](double probability) {
    return static_cast<double>(random() >> 11) * 0x1p-53 < probability;
  };
  const auto begin = std::chrono::steady_clock::now();
  const std::string* held = nullptr;  // sent after the next one
  for (const Packet& packet : packets_) {
    if (stop_) break;
    if (params_.speed > 0)
      std::this_thread::sleep_until(
          begin + std::chrono::duration_cast<std::chrono::nanoseconds>(
                      std::chrono::duration<double>(packet.after / params_.speed)));
    ++ledger_.made;
    if (happens(params_.loss)) {
      ++ledger_.dropped;
      continue;
    }
    if (!held && happens(params_.swap)) {
      ++ledger_.swapped;
      held = &packet.payload;
      continue;
    }
    send(socket, packet.payload);
    if (happens(params_.repeat)) {
      ++ledger_.repeated;
      send(socket, packet.payload);
    }
    if (held) send(socket, *held);
    held = nullptr;
  }
  if (held) send(socket, *held);
  ::close(socket);
  ended_ = true;
}

}  // namespace perception
