#include "libperception/sensors/frames/VelodyneCloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>
#include <utility>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Median.h"

namespace perception {

namespace {

using Scan = mrpt::obs::CObservationVelodyneScan;
using Packet = Scan::TVelodyneRawPacket;
using Calibration = mrpt::obs::VelodyneCalibration;

constexpr int kBlocks = Scan::BLOCKS_PER_PACKET, kReturns = Scan::SCANS_PER_BLOCK;
constexpr int kFullTurn = Scan::ROTATION_MAX_UNITS;  // [0.01 deg]
constexpr int kMostStep = 1000;       // [0.01 deg] between blocks; more is a gap, not a rotation
constexpr double kHour = 3600e6;      // [us] period of the packets' clock
constexpr double kLongestScan = 1.0;  // [s] 5 turns a second are the slowest setting
constexpr std::uint8_t kModelHdl32 = 0x21, kModelVlp16 = 0x22;

/// Firing times of the lasers of a block (VLP-16, HDL-32E and HDL-64E S3 user manuals).
struct Firing {
  double block;     ///< [us] between blocks of one azimuth step and the next
  double sequence;  ///< [us] between the firing sequences within a block
  double laser;     ///< [us] between lasers of a sequence
  int lasers;       ///< of a sequence within a block
};

Firing firingOf(std::size_t lasers) {
  if (lasers == 16) return {110.592, 55.296, 2.304, 16};
  if (lasers == 32) return {46.080, 46.080, 1.152, 32};
  return {48.0, 48.0, 1.5, 32};  // HDL-64E: both banks at once, spread evenly (table: within 5 us)
}

/// The scan's calibration, else MRPT's default for the model given in the packets.
const Calibration* calibrationOf(const Scan& scan) {
  if (!scan.calibration.empty()) return &scan.calibration;
  if (scan.scan_packets.empty()) return nullptr;
  const auto model = scan.scan_packets.front().velodyne_model_ID;
  try {
    const std::string name = model == kModelVlp16   ? "VLP16"
                             : model == kModelHdl32 ? "HDL32"
                                                    : "HDL64";
    const Calibration& usual = Calibration::LoadDefaultCalibration(name);
    return usual.empty() ? nullptr : &usual;
  } catch (const std::exception&) {  // MRPT 2.5.8 cannot read its own HDL64 file
    return nullptr;
  }
}

/// Ring number of each laser, by elevation from below.
std::vector<std::uint16_t> ringsOf(const Calibration& calibration) {
  const auto& lasers = calibration.laser_corrections;
  std::vector<std::size_t> order(lasers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return lasers[a].verticalCorrection < lasers[b].verticalCorrection;
  });
  std::vector<std::uint16_t> rings(lasers.size());
  for (std::size_t k = 0; k < order.size(); ++k) rings[order[k]] = static_cast<std::uint16_t>(k);
  return rings;
}

/// Sequence of the blocks of one packet.
struct PacketLayout {
  std::array<int, kBlocks> step{};     ///< azimuth step that a block belongs to, from 0
  std::array<int, kBlocks> partner{};  ///< the other block of a dual return, or -1
  double units_per_us = 0;             ///< [0.01 deg/us] rotation
};

bool usableBlock(const Scan::raw_block_t& block, bool banks) {
  const auto header = block.header();
  return (header == Scan::UPPER_BANK || (banks && header == Scan::LOWER_BANK)) &&
         block.rotation() < kFullTurn;
}

PacketLayout layoutOf(const Packet& packet, const Firing& firing, bool banks) {
  PacketLayout layout;
  layout.partner.fill(-1);
  const bool dual = !banks && packet.laser_return_mode == Scan::RETMODE_DUAL;
  int step = 0;
  for (int b = 0; b < kBlocks; ++b) {
    const auto& block = packet.blocks[b];
    if (b > 0) {
      // Blocks of one step share the azimuth: two banks, or two echoes, or both.
      const bool same = block.rotation() == packet.blocks[b - 1].rotation();
      if (dual ? b % 2 == 0 : !(banks && same)) ++step;
    }
    layout.step[static_cast<std::size_t>(b)] = step;
    for (int a = b - 1; a >= 0 && layout.step[static_cast<std::size_t>(a)] == step; --a) {
      if (packet.blocks[a].header() != block.header()) continue;
      layout.partner[static_cast<std::size_t>(a)] = b;
      layout.partner[static_cast<std::size_t>(b)] = a;
      break;
    }
  }
  // Median of the steps, robust to a bad block.
  std::vector<int> turned;
  for (int b = 1; b < kBlocks; ++b) {
    if (layout.step[static_cast<std::size_t>(b)] == layout.step[static_cast<std::size_t>(b) - 1])
      continue;
    const int by =
        (packet.blocks[b].rotation() - packet.blocks[b - 1].rotation() + kFullTurn) % kFullTurn;
    if (by > 0 && by <= kMostStep) turned.push_back(by);
  }
  if (!turned.empty()) layout.units_per_us = medianOf(std::move(turned)) / firing.block;
  return layout;
}

/// Appends the returns of packets to a cloud.
class VelodyneDecoder {
 public:
  VelodyneDecoder(const Scan& scan, const Calibration& calibration, VelodyneCounts& counts)
      : scan_(scan),
        lasers_(calibration.laser_corrections),
        rings_(ringsOf(calibration)),
        firing_(firingOf(lasers_.size())),
        banks_(lasers_.size() == 64),
        counts_(counts) {
    cloud_.max_range = scan.maxRange;
    const std::size_t most = scan.scan_packets.size() * Scan::SCANS_PER_PACKET;
    for (auto* values : {&cloud_.x, &cloud_.y, &cloud_.z, &cloud_.intensity, &cloud_.time_offset})
      values->reserve(most);
    cloud_.ring.reserve(most);
    cloud_.echo.reserve(most);
  }

  LidarCloud decode() {
    bool clock = true;
    for (const Packet& packet : scan_.scan_packets) {
      const double first = scan_.scan_packets.front().gps_timestamp();
      double since = static_cast<double>(packet.gps_timestamp()) - first;  // [us]
      if (since < -kHour / 2) since += kHour;
      clock = clock && since >= 0 && since < 1e6 * kLongestScan;
      decodePacket(packet, since);
    }
    if (!clock) cloud_.time_offset.clear();  // invalid time stamps
    if (!dual_) cloud_.echo.clear();
    return std::move(cloud_);
  }

 private:
  void decodePacket(const Packet& packet, double packet_us) {
    const PacketLayout layout = layoutOf(packet, firing_, banks_);
    for (int b = 0; b < kBlocks; ++b) {
      const auto& block = packet.blocks[b];
      if (!usableBlock(block, banks_)) {
        ++counts_.bad_blocks;
        continue;
      }
      const int partner = layout.partner[static_cast<std::size_t>(b)];
      const auto* other = partner < 0 ? nullptr : &packet.blocks[partner];
      if (other != nullptr && !usableBlock(*other, banks_)) other = nullptr;
      dual_ = dual_ || other != nullptr;
      const double block_us = packet_us + firing_.block * layout.step[static_cast<std::size_t>(b)];
      for (int k = 0; k < kReturns; ++k) {
        const double in_block =
            firing_.sequence * (k / firing_.lasers) + firing_.laser * (k % firing_.lasers);
        const double azimuth = block.rotation() + layout.units_per_us * in_block;
        const auto laser = static_cast<std::size_t>(k % firing_.lasers) +
                           (block.header() == Scan::LOWER_BANK ? 32U : 0U);
        const auto& echo = block.laser_returns[k];
        std::uint8_t number = 0;
        if (other != nullptr) {
          const auto& second = other->laser_returns[k];
          const bool same = second.distance() == echo.distance();
          if (same && partner < b) {
            counts_.duplicates += echo.distance() != 0;
            continue;
          }
          number = second.distance() != 0 && second.distance() < echo.distance() ? 1 : 0;
        }
        add(echo.distance(), echo.intensity(), azimuth, laser, block_us + in_block, number);
      }
    }
  }

  void add(int distance, int intensity, double azimuth_units, std::size_t laser, double us,
           std::uint8_t echo) {
    if (distance == 0) {
      ++counts_.no_return;
      return;
    }
    const auto& c = lasers_[laser];
    const double range =
        distance * static_cast<double>(Scan::DISTANCE_RESOLUTION) + c.distanceCorrection;
    if (range < scan_.minRange) {
      ++counts_.too_near;
      return;
    }
    const double azimuth = radians(0.01 * azimuth_units - c.azimuthCorrection);
    const double along =
        range * c.cosVertCorrection - c.verticalOffsetCorrection * c.sinVertCorrection;
    const double sine = std::sin(azimuth), cosine = std::cos(azimuth);
    // Velodyne's azimuth is clockwise from its y axis, which is x in the sensor frame.
    cloud_.x.push_back(static_cast<float>(along * cosine + c.horizontalOffsetCorrection * sine));
    cloud_.y.push_back(static_cast<float>(-along * sine + c.horizontalOffsetCorrection * cosine));
    cloud_.z.push_back(static_cast<float>(range * c.sinVertCorrection +
                                          c.verticalOffsetCorrection * c.cosVertCorrection));
    cloud_.intensity.push_back(static_cast<float>(intensity) / 255);
    cloud_.ring.push_back(rings_[laser]);
    cloud_.time_offset.push_back(static_cast<float>(1e-6 * us));
    cloud_.echo.push_back(echo);
  }

  const Scan& scan_;
  const std::vector<Calibration::PerLaserCalib>& lasers_;
  std::vector<std::uint16_t> rings_;
  Firing firing_;
  bool banks_;         ///< 64 lasers: a block holds one of two banks
  bool dual_ = false;  ///< some pulse has a dual return
  VelodyneCounts& counts_;
  LidarCloud cloud_;
};

}  // namespace

std::optional<LidarCloud> velodyneCloud(const Scan& scan, VelodyneCounts* counts) {
  const Calibration* calibration = calibrationOf(scan);
  if (calibration == nullptr) return {};
  const std::size_t lasers = calibration->laser_corrections.size();
  if (lasers != 16 && lasers != 32 && lasers != 64) return {};
  VelodyneCounts local;
  return VelodyneDecoder(scan, *calibration, counts != nullptr ? *counts : local).decode();
}

}  // namespace perception
