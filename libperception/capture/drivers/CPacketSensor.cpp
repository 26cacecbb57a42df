#include "libperception/capture/drivers/CPacketSensor.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>

#include <utility>

#include "libperception/core/Error.h"
#include "libperception/sensors/frames/ToObservation.h"

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CPacketSensor, perception)

namespace {

using mrpt::config::CConfigFileBase;

constexpr int kQuietMs = 200;  ///< without a packet after which the tail is whole

Transport transportOf(const std::string& section, const std::string& name, const DeviceKind& kind) {
  const bool can = kind.transport == Transport::kCan;
  if (name.empty()) return kind.transport;
  if (name == "can" && can) return Transport::kCan;
  if (name == "can_udp" && can) return Transport::kCanUdp;
  if (name == "udp" && !can) return Transport::kUdp;
  if (name == "tcp" && kind.transport == Transport::kTcp) return Transport::kTcp;
  throw ConfigError(fmt::format("[{}] transport = {}: {} comes by {}", section, name, kind.name,
                                can                                 ? "can or can_udp"
                                : kind.transport == Transport::kTcp ? "tcp or udp"
                                                                    : "udp"));
}

double probability(const CConfigFileBase& config, const std::string& section, const char* key) {
  const double value = config.read_double(section, key, 0);
  if (!(value >= 0 && value < 1))
    throw ConfigError(fmt::format("[{}] {} = {}: at least 0 and below 1", section, key, value));
  return value;
}

std::uint16_t portOf(const CConfigFileBase& config, const std::string& section, const char* key,
                     std::uint16_t otherwise) {
  const int port = config.read_int(section, key, otherwise);
  // A device of a CAN bus has no usual one.
  if (port < 0 || port > 65535 || (port == 0 && (otherwise != 0 || config.keyExists(section, key))))
    throw ConfigError(fmt::format("[{}] {} = {}: 1 to 65535 expected", section, key, port));
  return static_cast<std::uint16_t>(port);
}

/// Of a sensor's own faults: several with one seed do not lose the same packets.
std::uint64_t seedOf(std::uint64_t seed, const std::string& label) {
  for (const char c : label) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001B3;
  return seed;
}

}  // namespace

// MRPT has read sensorLabel and process_rate before.
void CPacketSensor::loadConfig_sensorSpecific(const CConfigFileBase& config,
                                              const std::string& section) {
  const auto text = [&](const char* key, const char* otherwise) {
    return config.read_string(section, key, otherwise);
  };
  const auto real = [&](const char* key) { return config.read_double(section, key, 0); };
  keys_.device = config.read_string(section, "device", "", true);
  keys_.device_file = text("device_file", "");
  const DeviceKind& kind = deviceKind(keys_.device);
  if (kind.needs_file && keys_.device_file.empty())
    throw ConfigError("[" + section + "] device_file: needed by " + keys_.device);
  keys_.transport = transportOf(section, text("transport", ""), kind);
  if (keys_.transport != Transport::kCan) keys_.port = portOf(config, section, "port", kind.port);
  keys_.host = text("host", "");
  keys_.multicast = text("multicast", "");
  keys_.interface = text("interface", "can0");
  keys_.time_offset = real("time_offset");
  keys_.source.T_ego_sensor =
      makePose(real("pose_x"), real("pose_y"), real("pose_z"), radians(real("pose_yaw")),
               radians(real("pose_pitch")), radians(real("pose_roll")));
  readSimulator(config, section, keys_);
  if (keys_.transport == Transport::kTcp && keys_.host.empty() && !keys_.simulated())
    throw ConfigError("[" + section + "] host: the device's address is needed");
}

void CPacketSensor::readSimulator(const CConfigFileBase& config, const std::string& section,
                                  Keys& keys) {
  keys.replay = config.read_string(section, "replay", "");
  keys.replay_port = portOf(config, section, "replay_port", deviceKind(keys.device).port);
  keys.replay_speed = config.read_double(section, "replay_speed", 1);
  if (!(keys.replay_speed >= 0))
    throw ConfigError(
        fmt::format("[{}] replay_speed = {}: at least 0 expected", section, keys.replay_speed));
  for (const std::string old : {"loss", "repeat", "swap"})
    if (config.keyExists(section, "replay_" + old))
      throw ConfigError("[" + section + "] replay_" + old + " is fault_" + old + " now");
  DeviceSource& source = keys.source;
  source.scenario.scenario = config.read_string(section, "scenario", "");
  source.scenario.seed = config.read_uint64_t(section, "seed", source.scenario.seed);
  source.scenario.start_delay =
      config.read_double(section, "start_delay", source.scenario.start_delay);
  if (!keys.replay.empty() && !source.scenario.scenario.empty())
    throw ConfigError("[" + section + "] replay and scenario: one of them");
  source.device_file = keys.device_file;
  source.bundled = keys.transport == Transport::kCanUdp;
  PacketFaults& faults = keys.faults;
  faults.loss = probability(config, section, "fault_loss");
  faults.repeat = probability(config, section, "fault_repeat");
  faults.swap = probability(config, section, "fault_swap");
  faults.torn = probability(config, section, "fault_torn");
  faults.seed = seedOf(source.scenario.seed, section);
  source.clock_step = config.read_double(section, "fault_clock_step", 0);
  source.clock_step_after = config.read_double(section, "fault_clock_step_after", 0);
  source.restart_after = config.read_double(section, "fault_restart_after", 0);
  if (!keys.simulated() && faults.any())
    throw ConfigError("[" + section + "] fault_...: need a simulated device: replay or scenario");
  if (source.scenario.scenario.empty() && (source.clock_step != 0 || source.restart_after != 0))
    throw ConfigError("[" + section +
                      "] fault_clock_step, fault_restart_after: need a scenario, "
                      "recorded packets are sent as they are");
}

std::unique_ptr<PacketSource> CPacketSensor::openSource() const {
  const bool simulated = keys_.simulated();
  switch (keys_.transport) {
    case Transport::kCan:
      return openCan(m_sensorLabel, keys_.interface);
    case Transport::kTcp:
      return openIbeoTcp(m_sensorLabel, simulated ? "127.0.0.1" : keys_.host, keys_.port);
    case Transport::kUdp:
    case Transport::kCanUdp:
      break;
  }
  return openUdp(m_sensorLabel, simulated ? "127.0.0.1" : "0.0.0.0", keys_.port,
                 simulated ? "" : keys_.multicast);
}

void CPacketSensor::startSimulator() {
  std::unique_ptr<PacketFeed> feed;
  if (!keys_.replay.empty()) {
    feed = std::make_unique<RecordedFeed>(keys_.replay, keys_.replay_port, keys_.replay_speed);
  } else {
    keys_.source.sensor = m_sensorLabel;
    feed = std::make_unique<ScenarioFeed>(deviceKind(keys_.device), keys_.source);
  }
  auto sink = keys_.transport == Transport::kTcp   ? loopbackTcp(keys_.port)
              : keys_.transport == Transport::kCan ? canSink(keys_.interface)
                                                   : loopbackUdp(keys_.port);
  simulator_ = std::make_unique<DeviceSimulator>(std::move(feed), std::move(sink), keys_.faults);
}

void CPacketSensor::initialize() {
  assembler_ = std::make_unique<FrameAssembler>(
      deviceKind(keys_.device), keys_.device_file, m_sensorLabel, keys_.source.T_ego_sensor,
      [this](SensorFrame&& frame) { frames_.push_back(std::move(frame)); });
  assembler_->setTransport(keys_.transport);
  assembler_->setTimeOffset(keys_.time_offset);
  source_ = openSource();
  if (keys_.simulated()) startSimulator();
  thread_ = std::thread([this] { receive(); });
  if (simulator_) simulator_->start();
  m_state = ssWorking;
}

CPacketSensor::~CPacketSensor() {
  simulator_.reset();
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void CPacketSensor::receive() {
  for (;;) {
    const bool any = source_->receive(kQuietMs, [this](const ReceivedPacket& p) { take(p); });
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      overrun_ = source_->overrun();
      for (const std::string& event : source_->takeEvents()) assembler_->note(event);
    }
    if (stop_ && (!any || !simulator_)) return;
  }
}

void CPacketSensor::take(const ReceivedPacket& packet) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool passes = senders_.passes(packet.sender, packet.at);
  if (const auto event = senders_.takeEvent()) assembler_->note(*event);
  if (passes) assembler_->add(packet.bytes, packet.at);
}

void CPacketSensor::doProcess() {
  std::vector<SensorFrame> frames;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    frames = std::exchange(frames_, {});
  }
  for (const SensorFrame& frame : frames) appendObservation(observationFromFrame(frame));
}

void CPacketSensor::endCapture() {
  if (simulator_) simulator_->stop();
  stop_ = true;  // a simulator's packets are received to the last; a device goes on sending
  if (thread_.joinable()) thread_.join();
  const std::lock_guard<std::mutex> lock(mutex_);
  assembler_->finish();
  if (simulator_ && !simulator_->fault().empty())
    assembler_->note("its simulator: " + simulator_->fault());
}

PacketLedger CPacketSensor::packets() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return assembler_->ledger();
}

std::vector<std::string> CPacketSensor::lostPackets() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return assembler_->lostRanges();
}

std::vector<std::string> CPacketSensor::warnings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return assembler_->warnings();
}

std::uint64_t CPacketSensor::refused() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return senders_.refused();
}

std::uint64_t CPacketSensor::overrun() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return overrun_;
}

ClockLedger CPacketSensor::clock() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return assembler_->clock();
}

}  // namespace perception
