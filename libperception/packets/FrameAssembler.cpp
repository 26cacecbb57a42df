#include "libperception/packets/FrameAssembler.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception {
namespace {

constexpr std::size_t kTold = 100;  ///< of each kind
/// [s] A turn takes at most 0.2 s (5 Hz); more is a gap, or a clock that was set.
constexpr double kLongestTurn = 0.5;
constexpr std::size_t kMostReturns = 2000000;  ///< bounds the memory of a turn that does not end

}  // namespace

FrameAssembler::FrameAssembler(const DeviceKind& kind, const std::string& file, std::string label,
                               const Pose3& T_ego_sensor, Take take)
    : kind_(kind), decoder_(kind.make(file)), transport_(kind.transport), take_(std::move(take)) {
  frame_.sensor = std::move(label);
  frame_.T_ego_sensor = T_ego_sensor;
}

void FrameAssembler::Notes::add(std::string text) {
  if (count++ < kTold) texts.push_back(std::move(text));
}

std::string FrameAssembler::sayWhere(const std::string& what) const {
  return fmt::format("{}: packet {}: {}", frame_.sensor, counter_.ledger().received, what);
}

std::vector<std::string> FrameAssembler::warnings() const {
  std::vector<std::string> all = faults_.texts;
  const auto addRest = [&](const Notes& notes, const char* what) {
    if (notes.count > notes.texts.size())
      all.push_back(
          fmt::format("{}: {} more {}", frame_.sensor, notes.count - notes.texts.size(), what));
  };
  addRest(faults_, "packets with a fault");
  all.insert(all.end(), events_.texts.begin(), events_.texts.end());
  addRest(events_, "events");
  return all;
}

void FrameAssembler::add(std::string_view payload, Stamp received) {
  if (transport_ == Transport::kCanUdp) return addBundle(payload, received);
  DecodedPacket packet;
  try {
    packet = decoder_->decode(payload);
  } catch (const DataError& error) {
    counter_.countDamaged();
    return warn(error.what());
  }
  if (isNew(packet)) take(packet, received);
}

/// A datagram with a frame that is refused counts as received; its other frames are taken.
void FrameAssembler::addBundle(std::string_view datagram, Stamp received) {
  CanBundle bundle;
  try {
    bundle = parseCanBundle(datagram);
  } catch (const DataError& error) {
    counter_.countDamaged();
    return warn(error.what());
  }
  DecodedPacket packet;
  packet.number = bundle.number;
  packet.numbers = 256;
  packet.identity = std::hash<std::string_view>()(datagram) | 1;
  if (!isNew(packet)) return;
  for (const std::string& message : bundle.messages) addMessage(message, received);
}

void FrameAssembler::addMessage(std::string_view message, Stamp received) {
  try {
    const DecodedPacket packet = decoder_->decode(message);
    if (scans_.count(packet)) take(packet, received);
  } catch (const DataError& error) {
    warn(error.what());
  }
}

bool FrameAssembler::isNew(const DecodedPacket& packet) {
  const auto restarts = counter_.ledger().restarts;
  const bool is_new = counter_.count(packet);
  if (counter_.ledger().restarts > restarts)
    note("its numbers begin anew: the device was restarted");
  return is_new;
}

void FrameAssembler::take(const DecodedPacket& packet, Stamp received) {
  for (const std::string& warning : packet.warnings) warn(warning);
  if (const auto change = clock_.add(packet, received)) note(*change);
  kind_.lidar ? addTurn(packet, received) : addTargets(packet, received);
}

void FrameAssembler::addTurn(const DecodedPacket& packet, Stamp received) {
  if (packet.returns.empty() && packet.stamp_ns == 0) return;  // a message without a scan
  std::int64_t since = packet.stamp_ns - first_clock_;
  if (since < -packet.clock_period_ns / 2) since += packet.clock_period_ns;
  double after = static_cast<double>(since) * 1e-9;
  const bool passed_zero = packet.turn < turn_ - 0.5F;  // less: packets out of order
  if (begun_ && (packet.ends_scan || passed_zero || std::abs(after) > kLongestTurn ||
                 cloud_.size() > kMostReturns))
    finish();
  if (!begun_) {
    begun_ = true;
    frame_.stamp = received + time_offset_;
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
    if (!packet.labeled) continue;
    cloud_.pulse_width.push_back(p.pulse_width);
    cloud_.label.push_back(p.label);
  }
  if (packet.ends_scan) finish();
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
    r.id = target.id;
    scan.returns.push_back(r);
  }
  SensorFrame frame = frame_;
  frame.stamp = received + time_offset_;
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
