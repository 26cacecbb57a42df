#include "libperception/capture/simulated/PacketFeed.h"

#include <fmt/format.h>
#include <algorithm>

#include <thread>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/packets/Pcap.h"
#include "libperception/packets/radars/CanBundle.h"
#include "libperception/sensors/frames/FromObservation.h"

namespace perception {
namespace {

using std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(2);
constexpr std::size_t kInBundle = 10;

steady_clock::duration durationOf(double seconds) {
  return std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

RecordedFeed::RecordedFeed(const std::string& pcap, std::uint16_t port, double speed)
    : speed_(speed) {
  PcapContents contents = readPcap(pcap);
  std::int64_t first = 0;
  for (UdpPacket& udp : contents.packets) {
    if (udp.port != port) continue;
    if (packets_.empty()) first = udp.stamp_ns;
    packets_.push_back({static_cast<double>(udp.stamp_ns - first) * 1e-9, std::move(udp.payload)});
  }
  if (packets_.empty()) throw DataError(fmt::format("{}: no packet to port {}", pcap, port));
}

std::optional<DuePacket> RecordedFeed::next(const std::atomic<bool>&) {
  if (at_ == packets_.size()) return std::nullopt;
  if (at_ == 0) begin_ = steady_clock::now();
  Packet& packet = packets_[at_++];
  const double after = speed_ > 0 ? packet.after / speed_ : 0;
  return DuePacket{begin_ + durationOf(after), std::move(packet.payload)};
}

ScenarioFeed::ScenarioFeed(const DeviceKind& kind, const DeviceSource& source)
    : source_(source),
      player_(ScenarioPlayer::shared(source.scenario)),
      encoder_(kind.makeEncoder(source.device_file)) {
  if (player_->has(source_.sensor)) return;
  std::string known;
  for (const std::string& label : player_->labels()) known += " " + label;
  throw ConfigError(fmt::format("[{}] of the capture INI: {} has no such sensor; it has{}",
                                source_.sensor, source_.scenario.scenario, known));
}

std::optional<DuePacket> ScenarioFeed::next(const std::atomic<bool>& stop) {
  while (waiting_.empty()) {
    for (const auto& observation : player_->take(source_.sensor)) encode(*observation);
    if (!waiting_.empty()) break;
    if (stop || player_->ended()) return std::nullopt;
    std::this_thread::sleep_for(kLook);
  }
  DuePacket packet = std::move(waiting_.front());
  waiting_.pop_front();
  return packet;
}

void ScenarioFeed::encode(const mrpt::obs::CObservation& observation) {
  std::optional<SensorFrame> frame = frameFromObservation(observation);
  if (!frame) return;
  if (!first_) first_ = frame->stamp;
  if (last_ && frame->stamp - *last_ > 0.01 && frame->stamp - *last_ < 0.5)
    period_ = frame->stamp - *last_;
  last_ = frame->stamp;
  const double t = frame->stamp - *first_;
  if (source_.restart_after > 0 && t >= source_.restart_after && !std::exchange(restarted_, true))
    encoder_->restart();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const Stamp now{std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count()};
  const auto begin = steady_clock::now() + durationOf(frame->stamp - now);
  if (source_.clock_step != 0 && t >= source_.clock_step_after)
    frame->stamp = frame->stamp + source_.clock_step;
  place(*frame);
  std::vector<TimedPacket> packets = encoder_->encode(*frame, period_);
  if (source_.bundled) packets = bundled(std::move(packets));
  for (TimedPacket& packet : packets)
    waiting_.push_back({begin + durationOf(packet.after), std::move(packet.payload)});
}

/// From the scenario's sensor to where the device is.
void ScenarioFeed::place(SensorFrame& frame) const {
  const Pose3 T = source_.T_ego_sensor.inverse() * frame.T_ego_sensor;
  auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (!cloud) {
    if (T.isApprox(Pose3::Identity(), 0.01)) return;
    throw ConfigError(fmt::format("[{}] pose_x ... are not those of {}: a radar's must be",
                                  source_.sensor, source_.scenario.scenario));
  }
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const Vector3 p = T * Vector3(cloud->x[i], cloud->y[i], cloud->z[i]);
    cloud->x[i] = static_cast<float>(p.x());
    cloud->y[i] = static_cast<float>(p.y());
    cloud->z[i] = static_cast<float>(p.z());
  }
}

std::vector<TimedPacket> ScenarioFeed::bundled(std::vector<TimedPacket> messages) {
  std::vector<TimedPacket> datagrams;
  for (std::size_t i = 0; i < messages.size(); i += kInBundle) {
    CanBundle bundle;
    bundle.number = bundles_++;
    for (std::size_t k = i; k < std::min(i + kInBundle, messages.size()); ++k)
      bundle.messages.push_back(std::move(messages[k].payload));
    datagrams.push_back({messages[i].after, canBundle(bundle)});
  }
  return datagrams;
}

}  // namespace perception
