#include "libperception/capture/CPacketSensor.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/sensors/ToObservation.h"

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CPacketSensor, perception)

namespace {

constexpr int kQuietMs = 200;  ///< without a packet after which the tail is whole
constexpr std::size_t kDatagram = 65536;
constexpr int kBuffer = 8 << 20;  ///< [bytes] asked of the kernel

Stamp stampNow() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count() / 100 * 100};
}

}  // namespace

// MRPT has read sensorLabel and process_rate before.
void CPacketSensor::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                              const std::string& section) {
  device_ = config.read_string(section, "device", "", true);
  file_ = config.read_string(section, "device_file", "");
  const DeviceKind& kind = deviceKind(device_);
  if (kind.port == 0) throw ConfigError("[" + section + "] " + device_ + " has no UDP packets");
  if (kind.needs_file && file_.empty())
    throw ConfigError("[" + section + "] device_file: needed by " + device_);
  port_ = static_cast<std::uint16_t>(config.read_int(section, "port", kind.port));
  const auto real = [&](const char* key) { return config.read_double(section, key, 0); };
  T_ego_sensor_ =
      makePose(real("pose_x"), real("pose_y"), real("pose_z"), radians(real("pose_yaw")),
               radians(real("pose_pitch")), radians(real("pose_roll")));
  replay_params_.pcap = config.read_string(section, "replay", "");
  if (replay_params_.pcap.empty()) return;
  bind_ = "127.0.0.1";
  replay_params_.from_port =
      static_cast<std::uint16_t>(config.read_int(section, "replay_port", kind.port));
  replay_params_.to_port = port_;
  replay_params_.speed = config.read_double(section, "replay_speed", 1);
  replay_params_.loss = real("replay_loss");
  replay_params_.repeat = real("replay_repeat");
  replay_params_.swap = real("replay_swap");
  replay_params_.seed = config.read_uint64_t(section, "seed", 1);
}

void CPacketSensor::initialize() {
  assembler_ = std::make_unique<FrameAssembler>(
      deviceKind(device_), file_, m_sensorLabel, T_ego_sensor_,
      [this](SensorFrame&& frame) { frames_.push_back(std::move(frame)); });
  if (!replay_params_.pcap.empty()) replay_ = std::make_unique<PacketReplay>(replay_params_);
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port_);
  ::inet_pton(AF_INET, bind_.c_str(), &at.sin_addr);
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kBuffer, sizeof kBuffer);
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    throw Error(ExitCode::kUnavailable,
                fmt::format("[{}] UDP port {}: {}", m_sensorLabel, port_, std::strerror(errno)));
  thread_ = std::thread([this] { receive(); });
  if (replay_) replay_->start();
  m_state = ssWorking;
}

CPacketSensor::~CPacketSensor() {
  replay_.reset();
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (socket_ >= 0) ::close(socket_);
}

void CPacketSensor::receive() {
  std::vector<char> bytes(kDatagram);
  for (;;) {
    pollfd wait{socket_, POLLIN, 0};
    const int ready = ::poll(&wait, 1, kQuietMs);
    if (stop_ && (ready == 0 || !replay_)) return;
    if (ready <= 0) continue;
    const auto count = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0) continue;
    const std::lock_guard<std::mutex> lock(mutex_);
    assembler_->add({bytes.data(), static_cast<std::size_t>(count)}, stampNow());
  }
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
  if (replay_) replay_->stop();
  stop_ = true;  // a simulator's packets are received to the last; a device goes on sending
  if (thread_.joinable()) thread_.join();
  const std::lock_guard<std::mutex> lock(mutex_);
  assembler_->finish();
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

}  // namespace perception
