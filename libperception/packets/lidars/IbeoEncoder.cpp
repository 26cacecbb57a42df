#include <algorithm>
#include <cmath>

#include "libperception/packets/Bytes.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/lidars/BeamView.h"
#include "libperception/packets/lidars/Ibeo.h"

namespace perception {
namespace {

constexpr std::size_t kBody = 44, kPoint = 10, kMost = 65535;
constexpr double kTicks = 11520;  ///< a turn
constexpr std::uint64_t kSynchronized = 0x20 | 3, kLabeledFlag = 7;

/// Scans 2202 of a LUX, one message each, with the labels, echoes and pulse widths of the cloud.
class IbeoEncoder final : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double period) override {
    const LidarCloud& cloud = cloudOf(frame);
    const std::size_t count = std::min(cloud.size(), kMost);
    std::string body(kBody + count * kPoint, '\0');
    const double scan = period / 2;  // forward half of the turn
    const std::int64_t end = frame.stamp.ns + static_cast<std::int64_t>(scan * 1e9);
    putLittle(body, 0, number_++, 2);
    putLittle(body, 2, kSynchronized, 2);
    putLittle(body, 6, ntpOf(frame.stamp.ns), 8);
    putLittle(body, 14, ntpOf(end), 8);
    putLittle(body, 22, static_cast<std::uint64_t>(kTicks), 2);
    putLittle(body, 24, static_cast<std::uint64_t>(kTicks / 4), 2);  // from the left
    putLittle(body, 26, static_cast<std::uint64_t>(-kTicks / 4 + 65536), 2);
    putLittle(body, 28, count, 2);
    putLittle(body, 42, cloud.label.empty() ? 0 : kLabeledFlag, 2);
    for (std::size_t i = 0; i < count; ++i) putPoint(body, kBody + i * kPoint, cloud, i);
    const std::string message = ibeoMessage(IbeoType::kLuxScan, end, previous_, body);
    previous_ = static_cast<std::uint32_t>(message.size());
    return {{scan, message}};
  }

  void restart() override { number_ = 0; }

 private:
  static void putPoint(std::string& body, std::size_t at, const LidarCloud& cloud, std::size_t i) {
    const double x = cloud.x[i], y = cloud.y[i], z = cloud.z[i];
    const double up = std::atan2(z, std::hypot(x, y)) * 180 / M_PI;
    std::size_t layer = 0;
    for (std::size_t k = 1; k < std::size(kIbeoLayers); ++k)
      if (std::abs(kIbeoLayers[k] - up) < std::abs(kIbeoLayers[layer] - up)) layer = k;
    const std::size_t echo = cloud.echo.empty() ? 0 : cloud.echo[i];
    body[at] = static_cast<char>(layer | (echo & 15) << 4);
    const auto label =
        cloud.label.empty() ? PointLabel::kUnknown : static_cast<PointLabel>(cloud.label[i]);
    body[at + 1] = static_cast<char>(label == PointLabel::kRain     ? 2
                                     : label == PointLabel::kGround ? 4
                                     : label == PointLabel::kDirt   ? 8
                                                                    : 0);
    const auto angle = std::lround(std::atan2(y, x) / (2 * M_PI) * kTicks);
    putLittle(body, at + 2, static_cast<std::uint64_t>(angle + 65536), 2);
    const auto centimeters = [](double meters) {
      return static_cast<std::uint64_t>(std::lround(std::clamp(100 * meters, 0.0, 65535.0)));
    };
    putLittle(body, at + 4, centimeters(std::sqrt(x * x + y * y + z * z)), 2);
    putLittle(body, at + 6, centimeters(cloud.pulse_width.empty() ? 0 : cloud.pulse_width[i]), 2);
  }

  std::uint16_t number_ = 0;
  std::uint32_t previous_ = 0;
};

}  // namespace

std::unique_ptr<PacketEncoder> makeIbeoEncoder(const std::string&) {
  return std::make_unique<IbeoEncoder>();
}

}  // namespace perception
