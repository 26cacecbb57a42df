#include "libperception/packets/FrameAssembler.h"

#include <cmath>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::size_t kWarnings = 100;
/// [s] A turn takes at most 0.2 s (5 Hz); more is a gap, or a clock that was set.
constexpr double kLongestTurn = 0.5;
constexpr std::size_t kMostReturns = 2000000;  ///< bounds the memory of a turn that does not end

}  // namespace

FrameAssembler::FrameAssembler(const DeviceKind& kind, const std::string& file, std::string label,
                               const Pose3& T_ego_sensor, Take take)
    : kind_(kind), decoder_(kind.make(file)), take_(std::move(take)) {
  frame_.sensor = std::move(label);
  frame_.T_ego_sensor = T_ego_sensor;
}

void FrameAssembler::warn(const std::string& what) {
  if (warnings_.size() < kWarnings)
    warnings_.push_back(frame_.sensor + ": packet " + std::to_string(counter_.ledger().received) +
                        ": " + what);
}

void FrameAssembler::add(std::string_view payload, Stamp received) {
  DecodedPacket packet;
  try {
    packet = decoder_->decode(payload);
  } catch (const DataError& error) {
    counter_.countDamaged();
    return warn(error.what());
  }
  if (!counter_.count(packet)) return;
  for (const std::string& warning : packet.warnings) warn(warning);
  kind_.lidar ? addTurn(packet, received) : addTargets(packet, received);
}

void FrameAssembler::addTurn(const DecodedPacket& packet, Stamp received) {
  double after = static_cast<double>(packet.stamp_ns - first_clock_) * 1e-9;
  const bool passed_zero = packet.turn < turn_ - 0.5F;  // less: packets out of order
  if (begun_ && (passed_zero || std::abs(after) > kLongestTurn || cloud_.size() > kMostReturns))
    finish();
  if (!begun_) {
    begun_ = true;
    frame_.stamp = received;
    first_clock_ = packet.stamp_ns;
    after = 0;
  }
  turn_ = packet.turn;
  for (const LidarReturn& p : packet.returns) {
    cloud_.x.push_back(p.x);
    cloud_.y.push_back(p.y);
    cloud_.z.push_back(p.z);
    cloud_.intensity.push_back(static_cast<float>(p.intensity) / 255);
    cloud_.ring.push_back(p.ring);
    cloud_.echo.push_back(p.echo);
    cloud_.time_offset.push_back(static_cast<float>(after + 1e-6 * p.time_us));
  }
}

void FrameAssembler::addTargets(const DecodedPacket& packet, Stamp received) {
  if (!packet.ends_scan) return;
  RadarReturns scan;
  scan.max_range = kind_.max_range;
  for (const PacketTarget& target : packet.targets) {
    RadarReturn r;
    r.range = target.range;
    r.bearing = target.azimuth;
    r.range_rate = target.range_rate;
    r.amplitude = target.rcs;
    if (target.has_elevation) r.elevation = target.elevation;
    scan.returns.push_back(r);
  }
  SensorFrame frame = frame_;
  frame.stamp = received;
  frame.data = std::move(scan);
  ++frames_;
  take_(std::move(frame));
}

void FrameAssembler::finish() {
  if (!begun_) return;
  begun_ = false;
  turn_ = 0;
  cloud_.max_range = kind_.max_range;
  SensorFrame frame = frame_;
  frame.data = std::exchange(cloud_, {});
  ++frames_;
  take_(std::move(frame));
}

}  // namespace perception
