#include "libperception/importers/positions/Ncom.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationGPS.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "libperception/core/Frames.h"
#include "libperception/packets/Bytes.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

constexpr std::size_t kNcomSize = 72, kNcomStatus = 21, kNcomSum = 61;
constexpr std::uint64_t kNcomSync = 0xE7, kNcomLocked = 4;

double threeBytes(std::string_view packet, std::size_t at, double unit) {
  const auto raw = static_cast<std::int32_t>(littleEndian(packet, at, 3));
  return unit * (raw >= 1 << 23 ? raw - (1 << 24) : raw);
}

template <class Real>
Real realAt(std::string_view packet, std::size_t at) {
  Real value = 0;
  std::memcpy(&value, packet.data() + at, sizeof value);
  return value;
}

double inDegrees(double angle) { return angle * 180 / M_PI; }

}  // namespace

std::optional<NcomState> ncomState(std::string_view packet) {
  if (packet.size() != kNcomSize || littleEndian(packet, 0, 1) != kNcomSync)
    throw std::runtime_error(
        fmt::format("{} bytes that are no NCOM packet: expected 72, the first E7", packet.size()));
  std::uint8_t sum = 0;
  for (std::size_t i = 1; i < kNcomSum; ++i) sum = static_cast<std::uint8_t>(sum + packet[i]);
  if (sum != littleEndian(packet, kNcomSum, 1))
    throw std::runtime_error("byte 61 of an NCOM packet: its sum is wrong");
  if (littleEndian(packet, kNcomStatus, 1) != kNcomLocked) return {};
  NcomState state;
  state.latitude = inDegrees(realAt<double>(packet, 23));
  state.longitude = inDegrees(realAt<double>(packet, 31));
  state.altitude = static_cast<double>(realAt<float>(packet, 39));
  constexpr double kSpeed = 1e-4, kAngle = 1e-6;  // [m/s], [rad]
  state.north = threeBytes(packet, 43, kSpeed);
  state.east = threeBytes(packet, 46, kSpeed);
  state.down = threeBytes(packet, 49, kSpeed);
  state.heading = inDegrees(threeBytes(packet, 52, kAngle));
  state.pitch = inDegrees(threeBytes(packet, 55, kAngle));
  state.roll = inDegrees(threeBytes(packet, 58, kAngle));
  const bool sound = std::abs(state.latitude) <= 90 && std::abs(state.longitude) <= 360 &&
                     std::isfinite(state.altitude);
  if (!sound) throw std::runtime_error("byte 23 of an NCOM packet: a place that is not on earth");
  return state;
}

std::shared_ptr<mrpt::obs::CObservation> ncomObservation(Stamp stamp, const NcomState& state) {
  using namespace mrpt::obs;
  gnss::Message_NV_OEM6_INSPVAS ins;
  ins.fields.lat = state.latitude;
  ins.fields.lon = state.longitude;
  ins.fields.hgt = state.altitude;
  ins.fields.vel_north = state.north;
  ins.fields.vel_east = state.east;
  ins.fields.vel_up = -state.down;
  ins.fields.azimuth = state.heading;
  ins.fields.pitch = state.pitch;
  ins.fields.roll = state.roll;
  ins.fields.ins_status = gnss::nv_oem6_ins_status_type::INS_SOLUTION_GOOD;
  auto out = std::make_shared<CObservationGPS>();
  out->timestamp = fromStamp(stamp);
  out->originalReceivedTimestamp = out->timestamp;
  out->has_satellite_timestamp = true;
  out->setMsg(ins);
  return out;
}

}  // namespace perception
