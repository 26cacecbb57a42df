#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "libperception/capture/simulated/PacketFeed.h"
#include "libperception/capture/simulated/PacketSink.h"

namespace perception {

/// What a device simulator does to its packets on the way: probabilities of a packet, [0, 1).
struct PacketFaults {
  double loss = 0, repeat = 0, swap = 0, torn = 0;
  std::uint64_t seed = 1;
  bool any() const { return loss > 0 || repeat > 0 || swap > 0 || torn > 0; }
};

/// What a device simulator has done, to the packet.
struct SentLedger {
  std::uint64_t made = 0;      ///< packets
  std::uint64_t dropped = 0;   ///< not sent on purpose
  std::uint64_t repeated = 0;  ///< sent twice
  std::uint64_t swapped = 0;   ///< sent after the next one
  std::uint64_t torn = 0;      ///< sent without their end
  std::uint64_t resent = 0;    ///< of these sent once more, whole: the last packet, 0 or 1
  std::uint64_t sent = 0;      ///< packets, of those sent twice both
  /// Numbers of the packets that did not arrive whole: dropped and torn ones. The first packet is
  /// 0.
  std::vector<std::uint64_t> missing;
};

/// A device simulator: sends packets of a feed when they are due. The first packet and the last one
/// are always sent whole, and the last one late, since no receiver can know what was lost before
/// its first or after its last packet.
class DeviceSimulator {
 public:
  DeviceSimulator(std::unique_ptr<PacketFeed> feed, std::unique_ptr<PacketSink> sink,
                  const PacketFaults& faults);
  ~DeviceSimulator();
  DeviceSimulator(const DeviceSimulator&) = delete;
  DeviceSimulator& operator=(const DeviceSimulator&) = delete;

  void start();
  /// Returns after the packet that is being sent.
  void stop();
  bool ended() const { return ended_; }
  const SentLedger& ledger() const { return ledger_; }  ///< after stop() or ended()
  /// Why it ended early, or what it could not send; empty if all is well. Call after stop() or
  /// ended().
  const std::string& fault() const { return fault_; }

 private:
  void run();
  void sendAll();
  void sendOne(std::string payload);
  void send(const std::string& payload);
  bool happens(double probability);

  std::unique_ptr<PacketFeed> feed_;
  std::unique_ptr<PacketSink> sink_;
  const PacketFaults faults_;
  std::mt19937_64 random_;
  std::string held_;    ///< sent after the next one
  std::string unseen_;  ///< the newest packet, if it came not whole: no later one shows that
  bool unseen_was_dropped_ = false;
  SentLedger ledger_;
  std::uint64_t unsent_ = 0;  ///< packets that the network refused
  std::string unsent_why_, fault_;
  std::atomic<bool> stop_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace perception
