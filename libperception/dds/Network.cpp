#include "libperception/dds/Network.h"

#include <dds/dds.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr int kHistory = 50;
constexpr std::uint32_t kLastDomain = 230;  // ports of later ones do not exist

int checked(int entity, const std::string& what) {
  if (entity < 0)
    throw Error(ExitCode::kUnavailable, fmt::format("DDS: {}: {}", what, dds_strretcode(-entity)));
  return entity;
}

/// Multicast to find each other; data goes from one to one on loopback.
std::string configurationOf(const NetworkName& name) {
  return fmt::format(
      "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"{}\"{}/>"
      "</Interfaces><AllowMulticast>spdp</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
      "</General><Internal><SocketReceiveBufferSize min=\"default\" max=\"8MB\"/></Internal>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>",
      name.interface, name.interface == "lo" ? " multicast=\"true\"" : "");
}

struct Qos {
  explicit Qos(Network::History history) {
    const bool latched = history == Network::History::kLatched;
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, latched ? 1 : kHistory);
    dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  }
  ~Qos() { dds_delete_qos(qos); }
  Qos(const Qos&) = delete;
  Qos& operator=(const Qos&) = delete;

  dds_qos_t* qos = dds_create_qos();
};

}  // namespace

NetworkName NetworkName::parse(const std::string& text) {
  NetworkName name;
  const auto colon = text.find(':');
  name.interface = text.substr(0, colon);
  bool good =
      !name.interface.empty() &&
      name.interface.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") == std::string::npos;
  if (colon != std::string::npos) {
    const std::string number = text.substr(colon + 1);
    good = good && !number.empty() && number.size() < 4 &&
           number.find_first_not_of("0123456789") == std::string::npos;
    if (good) name.domain = static_cast<std::uint32_t>(std::stoul(number));
  }
  if (!good || name.domain > kLastDomain)
    throw Error(ExitCode::kUsage,
                fmt::format("'{}': expected INTERFACE or INTERFACE:DOMAIN, as lo:0, domain 0 to {}",
                            text, kLastDomain));
  return name;
}

std::shared_ptr<Network> Network::join(const NetworkName& name) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::uint32_t>, std::weak_ptr<Network>> networks;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& known = networks[{name.interface, name.domain}];
  auto network = known.lock();
  if (!network) known = network = std::shared_ptr<Network>(new Network(name));
  return network;
}

Network::Network(const NetworkName& name) {
  if (std::getenv("CYCLONEDDS_URI") == nullptr) {
    const std::string configuration = configurationOf(name);
    domain_ = checked(dds_create_domain(name.domain, configuration.c_str()),
                      "network interface " + name.interface);
  }
  participant_ = dds_create_participant(name.domain, nullptr, nullptr);
  if (participant_ < 0 && domain_ > 0) dds_delete(domain_);
  checked(participant_,
          fmt::format("network interface {}, domain {}", name.interface, name.domain));
}

Network::~Network() {
  dds_delete(participant_);
  if (domain_ > 0) dds_delete(domain_);
}

int Network::topic(const dds_topic_descriptor& type, const std::string& name) {
  return checked(dds_create_topic(participant_, &type, name.c_str(), nullptr, nullptr),
                 "topic " + name);
}

int Network::writer(const dds_topic_descriptor& type, const std::string& name, History history) {
  const Qos qos(history);
  return checked(dds_create_writer(participant_, topic(type, name), qos.qos, nullptr),
                 "writer of " + name);
}

int Network::reader(const dds_topic_descriptor& type, const std::string& name, History history) {
  const Qos qos(history);
  return checked(dds_create_reader(participant_, topic(type, name), qos.qos, nullptr),
                 "reader of " + name);
}

}  // namespace perception
