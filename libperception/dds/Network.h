#pragma once
#include <cstdint>
#include <memory>
#include <string>

struct dds_topic_descriptor;

namespace perception {

/// Which DDS network: "INTERFACE" or "INTERFACE:DOMAIN", as in "lo:0" (domain 0 to 230, ROS 2's
/// ROS_DOMAIN_ID).
struct NetworkName {
  std::string interface = "lo";
  std::uint32_t domain = 0;

  /// Throws Error (kUsage).
  static NetworkName parse(const std::string& text);
};

/// A participant of Cyclone DDS. On the loopback interface nothing leaves the machine. If the
/// environment has CYCLONEDDS_URI, that configuration replaces the interface.
class Network {
 public:
  /// The participant of this process, shared while anyone holds it. Throws Error (kUnavailable).
  static std::shared_ptr<Network> join(const NetworkName& name);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  enum class History { kNewest, kLatched };
  /// Reliable: the last 50 messages are kept for slow readers, and with kLatched the last one also
  /// for readers that join late. Entities of Cyclone DDS, which live as long as this. Throws Error
  /// (kUnavailable).
  int writer(const dds_topic_descriptor& type, const std::string& topic,
             History history = History::kNewest);
  int reader(const dds_topic_descriptor& type, const std::string& topic,
             History history = History::kNewest);

  /// The entity of Cyclone DDS.
  int participant() const { return participant_; }

 private:
  explicit Network(const NetworkName& name);
  int topic(const dds_topic_descriptor& type, const std::string& name);

  int domain_ = 0, participant_ = 0;
};

}  // namespace perception
