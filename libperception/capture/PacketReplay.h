#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace perception {

/// What a device simulator sends and what it does to the packets on the way.
struct ReplayParams {
  std::string pcap;
  std::uint16_t from_port = 0;            ///< packets of the capture to this port are sent
  std::uint16_t to_port = 0;              ///< of this machine's loopback interface
  double speed = 1;                       ///< of the recording's; 0: as fast as possible
  double loss = 0, repeat = 0, swap = 0;  ///< probabilities of a packet, [0, 1)
  std::uint64_t seed = 1;
};

/// What a device simulator has done, to the packet.
struct SentLedger {
  std::uint64_t made = 0;      ///< packets of the capture
  std::uint64_t dropped = 0;   ///< not sent on purpose
  std::uint64_t repeated = 0;  ///< sent twice
  std::uint64_t swapped = 0;   ///< sent after the next one
  std::uint64_t sent = 0;      ///< datagrams
};

/// A device simulator: sends recorded packets once by UDP on loopback, with their own pauses.
class PacketReplay {
 public:
  /// Reads the capture. Throws DataError.
  explicit PacketReplay(const ReplayParams& params);
  ~PacketReplay();
  PacketReplay(const PacketReplay&) = delete;
  PacketReplay& operator=(const PacketReplay&) = delete;

  void start();
  /// Returns after the packet that is being sent.
  void stop();
  bool ended() const { return ended_; }
  SentLedger ledger() const;  ///< after stop() or ended()

 private:
  void run();
  void send(int socket, const std::string& payload);

  struct Packet {
    double after = 0;  ///< [s] the first one
    std::string payload;
  };
  ReplayParams params_;
  std::vector<Packet> packets_;
  SentLedger ledger_;
  std::atomic<bool> stop_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace perception
