// Clouds of recorded packets against those of another decoder.
#include <gtest/gtest.h>

#include "libperception/packets/Bytes.h"
#include "tests/packets/Recorded.h"

namespace perception {
namespace {

struct Recording {
  const char* folder;
  const char* kind;
  const char* file;
  std::size_t packets, stride;  ///< stride: of a point of the truth [bytes]
  double share;                 ///< of the truth's points that lie within 2 mm of one of ours
};

/// A point as the truth has it: Hesai's axes are right, forward, up; Velodyne's azimuths are
/// rounded to 0.01 deg, and the lasers of a VLP-32C turn by `late` [deg] more, by their full number
/// in the block, though they fire in pairs.
Place inTruth(const std::string& kind, const LidarReturn& p, double late) {
  if (kind != "velodyne") return {-p.y, p.x, p.z};
  const double azimuth = std::atan2(-p.y, p.x) * 180 / M_PI + late;
  const double rounded = std::round(azimuth * 100) / 100 * M_PI / 180, flat = std::hypot(p.x, p.y);
  return {static_cast<float>(flat * std::cos(rounded)),
          static_cast<float>(-flat * std::sin(rounded)), p.z};
}

/// By how much the truth turns a return of a Velodyne further than we do [deg], for a laser with an
/// odd number in its block or an even one. It does not interpolate in the last block (of a dual
/// return: in the last but one), and it counts the lasers of a VLP-32C one by one.
double lateInTruth(std::string_view payload, const LidarReturn& p, bool odd) {
  const bool vlp32c = payload[1205] == 0x28;
  const std::size_t echoes = vlp32c ? 1 : 2;
  const double period = vlp32c ? 55.296 : 110.592;
  const auto firing = static_cast<std::size_t>((p.time_us + .01) / period);
  const double in_block = p.time_us - static_cast<double>(firing) * period;
  const std::size_t block = echoes * firing + p.echo, last = 12 - echoes;
  const std::size_t from = std::min(block, last - echoes);
  const auto azimuth = [&](std::size_t b) { return littleEndian(payload, 100 * b + 2, 2); };
  const auto step =
      static_cast<double>((azimuth(from + echoes) + 36000 - azimuth(from)) % 36000) / 100;
  // Of equal dual returns the truth may have the second, in the block that it interpolates.
  if (block == last && (vlp32c || !odd)) return -step * in_block / period;
  return vlp32c ? step * (in_block + (odd ? 2.304 : 0)) / period : 0;
}

class RecordedClouds : public testing::TestWithParam<Recording> {};

TEST_P(RecordedClouds, AreThoseOfTheTruth) {
  SKIP_WITHOUT_RECORDINGS();
  const Recording& r = GetParam();
  const std::string folder = recordedFolder() + r.folder;
  const std::string path = folder + "/packets.pcap";
  const PcapContents contents = readPcap(std::filesystem::exists(path) ? path : path + ".gz");
  EXPECT_EQ(contents.packets.size(), r.packets);
  EXPECT_TRUE(contents.warnings.empty());
  const auto decoder = deviceKind(r.kind).make(*r.file ? folder + "/" + r.file : "");
  NearestPlace ours(0.002);
  SequenceCounter counter;
  for (const UdpPacket& udp : contents.packets) {
    const DecodedPacket packet = decoder->decode(udp.payload);
    EXPECT_TRUE(counter.count(packet));
    for (const LidarReturn& p : packet.returns) {
      for (const bool odd : {false, true}) {
        const double late = *r.file ? 0 : lateInTruth(udp.payload, p, odd);
        ours.add(inTruth(r.kind, p, late));
      }
    }
  }
  EXPECT_EQ(counter.ledger().lost, 0U);
  const auto truth = readTruth(r.folder, r.stride);
  std::size_t close = 0;
  for (const Place& p : truth) close += ours.distance(p) < 0.002 ? 1 : 0;
  EXPECT_GE(static_cast<double>(close), r.share * static_cast<double>(truth.size()))
      << close << " of " << truth.size();
}

INSTANTIATE_TEST_SUITE_P(
    Devices, RecordedClouds,
    testing::Values(Recording{"vlp16", "velodyne", "", 603, 32, 0.989},
                    Recording{"vlp32c", "velodyne", "", 379, 12, 0.999},
                    Recording{"hesai_pandar40p", "pandar40p", "Pandar40P.csv", 1439, 12, 1},
                    Recording{"hesai_xt32", "xt32", "PandarXT32.csv", 2000, 12, 1}),
    [](const auto& info) { return std::string(info.param.folder); });

}  // namespace
}  // namespace perception
