#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/lidars/BeamView.h"
#include "libperception/packets/lidars/RoboSense.h"

namespace perception {
namespace {

/// A lidar that turns and fires all beams again and again, whatever the turn's phase.
class SpinningEncoder : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double period) final {
    const LidarCloud& cloud = cloudOf(frame);
    const BeamView view(cloud, beams());
    const std::int64_t begin = frame.stamp.ns, turn = std::llround(period * 1e9);
    const auto share = [turn](auto ns) {
      return 360 * static_cast<double>(ns) / static_cast<double>(turn);
    };
    const double step = share(firing());
    const bool goes_on = next_ > begin - turn && next_ < begin + turn;
    if (!goes_on) next_ = begin, firings_.clear();
    std::vector<TimedPacket> packets;
    for (; next_ < begin + turn; next_ += firing()) {
      Firing one;
      one.at = next_;
      one.azimuth = share(next_ - begin);
      for (std::size_t i = 0; i < beams().size(); ++i) {
        const double azimuth = one.azimuth + share(laserTime(i)) + beams()[i].azimuth;
        one.seen.push_back(view.at(i, azimuth, step));
      }
      firings_.push_back(std::move(one));
      if (firings_.size() < inPacket()) continue;
      packets.push_back({std::max(0.0, 1e-9 * static_cast<double>(next_ - begin)), pack(firings_)});
      firings_.clear();
    }
    return packets;
  }

  void restart() override {
    next_ = 0;
    firings_.clear();
  }

 protected:
  struct Firing {
    std::int64_t at = 0;  ///< [ns] since 1970, of the device's clock
    double azimuth = 0;   ///< [deg]
    std::vector<std::optional<BeamView::Seen>> seen;
  };

  virtual const std::vector<BeamAngles>& beams() const = 0;
  virtual std::int64_t firing() const = 0;                         ///< [ns] from one to the next
  virtual std::int64_t laserTime(std::size_t) const { return 0; }  ///< [ns] after the firing
  virtual std::size_t inPacket() const = 0;                        ///< firings
  virtual std::string pack(const std::vector<Firing>& firings) = 0;

  /// Distance and reflectivity, three bytes.
  static void putReturn(std::string& bytes, std::size_t at,
                        const std::optional<BeamView::Seen>& seen, double unit) {
    if (!seen) return;
    const double raw = std::round(seen->range / unit);
    if (raw > 65535) return;
    putLittle(bytes, at, static_cast<std::uint64_t>(raw), 2);
    bytes[at + 2] = static_cast<char>(std::lround(std::clamp(seen->intensity, 0.F, 1.F) * 255));
  }
  static std::uint64_t centidegrees(double azimuth) {
    const long hundredths = std::lround(azimuth * 100) % 36000;
    return static_cast<std::uint64_t>(hundredths < 0 ? hundredths + 36000 : hundredths);
  }

 private:
  std::int64_t next_ = 0;  ///< [ns] since 1970, the next firing
  std::vector<Firing> firings_;
};

/// Strongest returns of VLP-16 or VLP-32C.
class VelodyneEncoder final : public SpinningEncoder {
 public:
  explicit VelodyneEncoder(bool vlp16) : small_(vlp16) {}

 private:
  const std::vector<BeamAngles>& beams() const override {
    return small_ ? vlp16Beams() : vlp32cBeams();
  }
  std::int64_t firing() const override { return 55296; }
  std::int64_t laserTime(std::size_t i) const override {
    return 2304 * static_cast<std::int64_t>(small_ ? i : i / 2);
  }
  std::size_t inPacket() const override { return small_ ? 24 : 12; }
  std::string pack(const std::vector<Firing>& firings) override {
    constexpr std::size_t kBlock = 100;
    std::string bytes(1206, '\0');
    for (std::size_t f = 0; f < firings.size(); ++f) {
      const std::size_t block = (small_ ? f / 2 : f) * kBlock;
      const bool second = small_ && f % 2 == 1;
      if (!second) bytes.replace(block, 2, "\xFF\xEE");
      if (!second) putLittle(bytes, block + 2, centidegrees(firings[f].azimuth), 2);
      for (std::size_t i = 0; i < beams().size(); ++i)
        putReturn(bytes, block + 4 + 3 * (i + (second ? 16 : 0)), firings[f].seen[i],
                  small_ ? 0.002 : 0.004);
    }
    constexpr std::int64_t kHour = 3'600'000'000;  // [us]
    putLittle(bytes, 1200, static_cast<std::uint64_t>(firings.front().at / 1000 % kHour), 4);
    bytes.replace(1204, 2, small_ ? "\x37\x22" : "\x37\x28");
    return bytes;
  }

  const bool small_;
};

/// Pandar40P with numbered packets, or XT32.
class HesaiEncoder final : public SpinningEncoder {
 public:
  HesaiEncoder(bool xt32, const std::string& file)
      : xt32_(xt32),
        beams_(!file.empty() ? readBeams(file, xt32 ? 32 : 40)
               : xt32        ? xt32Beams()
                             : pandar40pBeams()) {}
  void restart() override {
    SpinningEncoder::restart();
    number_ = 0;
  }

 private:
  const std::vector<BeamAngles>& beams() const override { return beams_; }
  std::int64_t firing() const override { return xt32_ ? 50000 : 55560; }
  std::size_t inPacket() const override { return xt32_ ? 8 : 10; }

  std::string pack(const std::vector<Firing>& firings) override {
    std::string bytes(xt32_ ? 1080 : 1266, '\0');
    const std::size_t first = xt32_ ? 12 : 0, block = xt32_ ? 130 : 124, channel = xt32_ ? 4 : 3;
    const std::size_t flag = xt32_ ? 0 : 2;
    if (xt32_) bytes.replace(0, 12, std::string("\xEE\xFF\6\1\0\0\x20\x08\1\4\1\1", 12));
    for (std::size_t f = 0; f < firings.size(); ++f) {
      const std::size_t at = first + block * f;
      if (!xt32_) bytes.replace(at, 2, "\xFF\xEE");
      putLittle(bytes, at + flag, centidegrees(firings[f].azimuth), 2);
      for (std::size_t i = 0; i < beams_.size(); ++i)
        putReturn(bytes, at + flag + 2 + channel * i, firings[f].seen[i], 0.004);
    }
    // The packet's stamp is that of its end.
    putTail(bytes, firings.back().at + (xt32_ ? 0 : 28580));
    return bytes;
  }

  void putTail(std::string& bytes, std::int64_t ns) {
    const std::time_t seconds = ns / 1'000'000'000;
    std::tm calendar{};
    gmtime_r(&seconds, &calendar);
    const std::size_t at = xt32_ ? 1065 : 1256;
    bytes[at] = static_cast<char>(calendar.tm_year - (xt32_ ? 0 : 100));
    bytes[at + 1] = static_cast<char>(calendar.tm_mon + 1);
    bytes[at + 2] = static_cast<char>(calendar.tm_mday);
    bytes[at + 3] = static_cast<char>(calendar.tm_hour);
    bytes[at + 4] = static_cast<char>(calendar.tm_min);
    bytes[at + 5] = static_cast<char>(calendar.tm_sec);
    const auto rest = static_cast<std::uint64_t>(ns % 1'000'000'000 / 1000);  // [us]
    putLittle(bytes, xt32_ ? 1071 : 1250, rest, 4);
    bytes[xt32_ ? 1062 : 1254] = '\x37';
    bytes[xt32_ ? 1075 : 1255] = '\x42';
    putLittle(bytes, xt32_ ? 1076 : 1262, number_++, 4);
  }

  const bool xt32_;
  const std::vector<BeamAngles> beams_;
  std::uint32_t number_ = 0;
};

class RoboSenseEncoder final : public SpinningEncoder {
 public:
  RoboSenseEncoder(const RoboSenseModel& model, const std::string& file)
      : model_(model), beams_(robosenseBeams(file, model)) {
    if (beams_.empty())
      throw ConfigError("a simulated " + std::string(model.name) +
                        ": device_file: the beams of the unit are needed");
  }

 private:
  const std::vector<BeamAngles>& beams() const override { return beams_; }
  std::int64_t firing() const override { return std::llround(1e3 * model_.firing); }
  std::int64_t laserTime(std::size_t i) const override {
    return std::llround(1e3 * model_.laserTime(i));
  }
  std::size_t inPacket() const override { return 12 * firingsInBlock(); }
  std::size_t firingsInBlock() const { return 32 / model_.lasers; }

  std::string pack(const std::vector<Firing>& firings) override {
    std::string bytes(kRoboSenseSize, '\0');
    const std::int64_t at = firings.front().at;
    if (model_.id == kHeliosId) {
      bytes.replace(0, 4, "\x55\xAA\x05\x5A");
      putBig(bytes, 10, static_cast<std::uint64_t>(at / 1'000'000'000), 6);
      putBig(bytes, 16, static_cast<std::uint64_t>(at / 1000 % 1'000'000), 4);
    } else {
      bytes.replace(0, 8, "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0");
      bytes[30] = static_cast<char>(model_.id);
      putStamp(bytes, at);
    }
    for (std::size_t f = 0; f < firings.size(); ++f) {
      const std::size_t block = 42 + 100 * (f / firingsInBlock());
      const std::size_t part = f % firingsInBlock();
      if (part == 0) bytes.replace(block, 2, "\xFF\xEE");
      if (part == 0) putBig(bytes, block + 2, centidegrees(firings[f].azimuth), 2);
      for (std::size_t i = 0; i < beams_.size(); ++i)
        putSeen(bytes, block + 4 + 3 * (i + part * model_.lasers), i, firings[f].seen[i]);
    }
    putBig(bytes, kRoboSenseSize - 2, 0x00FF, 2);
    return bytes;
  }

  void putSeen(std::string& bytes, std::size_t at, std::size_t beam,
               std::optional<BeamView::Seen> seen) const {
    if (seen) seen->range -= model_.lens * std::cos(beams_[beam].elevation * M_PI / 180);
    if (!seen || seen->range < 0) return;
    putReturn(bytes, at, seen, model_.unit);
    std::swap(bytes[at], bytes[at + 1]);
  }

  static void putStamp(std::string& bytes, std::int64_t ns) {
    const std::time_t seconds = ns / 1'000'000'000;
    std::tm calendar{};
    gmtime_r(&seconds, &calendar);
    const int fields[] = {calendar.tm_year - 100, calendar.tm_mon + 1, calendar.tm_mday,
                          calendar.tm_hour,       calendar.tm_min,     calendar.tm_sec};
    for (std::size_t i = 0; i < std::size(fields); ++i)
      bytes[20 + i] = static_cast<char>(fields[i]);
    putBig(bytes, 26, static_cast<std::uint64_t>(ns / 1'000'000 % 1000), 2);
    putBig(bytes, 28, static_cast<std::uint64_t>(ns / 1000 % 1000), 2);
  }

  const RoboSenseModel& model_;
  const std::vector<BeamAngles> beams_;
};

}  // namespace

std::unique_ptr<PacketEncoder> makeRs16Encoder(const std::string& file) {
  return std::make_unique<RoboSenseEncoder>(kRs16, file);
}

std::unique_ptr<PacketEncoder> makeRs32Encoder(const std::string& file) {
  return std::make_unique<RoboSenseEncoder>(kRs32, file);
}

std::unique_ptr<PacketEncoder> makeHelios16Encoder(const std::string& file) {
  return std::make_unique<RoboSenseEncoder>(kHelios16, file);
}

std::unique_ptr<PacketEncoder> makeHelios32Encoder(const std::string& file) {
  return std::make_unique<RoboSenseEncoder>(kHelios32, file);
}

std::unique_ptr<PacketEncoder> makeBpearlEncoder(const std::string& file) {
  return std::make_unique<RoboSenseEncoder>(kBpearl, file);
}

std::unique_ptr<PacketEncoder> makeVelodyneEncoder(const std::string& file) {
  if (!file.empty() && file != "VLP-16" && file != "VLP-32C")
    throw ConfigError("a simulated velodyne: device_file = " + file + ": VLP-16 or VLP-32C");
  return std::make_unique<VelodyneEncoder>(file != "VLP-32C");
}

std::unique_ptr<PacketEncoder> makePandar40pEncoder(const std::string& file) {
  return std::make_unique<HesaiEncoder>(false, file);
}

std::unique_ptr<PacketEncoder> makeXt32Encoder(const std::string& file) {
  return std::make_unique<HesaiEncoder>(true, file);
}

}  // namespace perception
