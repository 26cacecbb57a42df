// Damaged captures: the stated warning, and nothing lost but the damaged packets.
#include <algorithm>
#include <memory>

#include "libperception/packets/FrameAssembler.h"
#include "tests/packets/Recorded.h"

namespace perception {
namespace {

struct Read {
  std::uint64_t returns = 0;
  PacketLedger ledger;
  std::vector<std::string> warnings;  ///< of the file and of the packets
  std::vector<std::string> lost;
};

Read readXt32(const std::string& bytes) {
  const PcapContents contents = parsePcap(bytes, "xt32.pcap");
  Read read;
  read.warnings = contents.warnings;
  FrameAssembler assembler(
      deviceKind("xt32"), "", "XT32", Pose3::Identity(),
      [&](SensorFrame&& frame) { read.returns += std::get<LidarCloud>(frame.data).size(); });
  for (const UdpPacket& packet : contents.packets)
    assembler.add(packet.payload, Stamp{packet.stamp_ns});
  assembler.finish();
  read.ledger = assembler.ledger();
  read.lost = assembler.lostRanges();
  for (const std::string& warning : assembler.warnings()) read.warnings.push_back(warning);
  return read;
}

constexpr std::size_t kRecord = 16 + 42 + 1080;
constexpr std::size_t recordAt(std::size_t i) { return 24 + i * kRecord; }

class DamagedCapture : public testing::Test {
 protected:
  void SetUp() override {
    SKIP_WITHOUT_RECORDINGS();
    const std::string path = recordedFolder() + "hesai_xt32/packets.pcap";
    bytes_ = readPossiblyGzipped(std::filesystem::exists(path) ? path : path + ".gz");
    ASSERT_EQ(bytes_.size(), recordAt(2000));
    whole_ = readXt32(bytes_);
    EXPECT_TRUE(whole_.warnings.empty());
  }

  /// Returns of packet i, as it is in the whole capture.
  std::uint64_t returnsOf(std::size_t i) const {
    const auto payload = std::string_view(bytes_).substr(recordAt(i) + 58, 1080);
    return deviceKind("xt32").make("")->decode(payload).returns.size();
  }

  std::string bytes_;
  Read whole_;
};

TEST_F(DamagedCapture, APacketWithWrongBytesCostsItselfAndIsNamed) {
  std::string bytes = bytes_;
  bytes[recordAt(700) + 58] = '\0';  // the header's first byte
  const Read read = readXt32(bytes);
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("packet 701: XT32 packet: byte 0: header EE FF 06 expected"),
            std::string::npos)
      << read.warnings[0];
  EXPECT_EQ(read.ledger.damaged, 1U);
  EXPECT_EQ(read.ledger.lost, 1U);
  EXPECT_EQ(read.returns, whole_.returns - returnsOf(700));
}

TEST_F(DamagedCapture, RecordsThatAreMissingAreListedByTheirNumbers) {
  std::string bytes = bytes_;
  bytes.erase(recordAt(1000), 3 * kRecord);
  const Read read = readXt32(bytes);
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(read.ledger.lost, 3U);
  ASSERT_EQ(read.lost.size(), 1U);
  EXPECT_EQ(read.returns, whole_.returns - returnsOf(1000) - returnsOf(1001) - returnsOf(1002));
}

TEST_F(DamagedCapture, ATornEndCostsTheLastPacket) {
  const Read read = readXt32(bytes_.substr(0, bytes_.size() - 100));
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("record 2000 is torn"), std::string::npos) << read.warnings[0];
  EXPECT_EQ(read.ledger.received, 1999U);
  EXPECT_EQ(read.returns, whole_.returns - returnsOf(1999));
}

TEST_F(DamagedCapture, ADatagramWithAWrongLengthCostsItself) {
  std::string bytes = bytes_;
  bytes[recordAt(5) + 16 + 14 + 20 + 4] = '\x7F';  // of the UDP header
  const Read read = readXt32(bytes);
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("record 6 has a UDP length that does not fit"), std::string::npos)
      << read.warnings[0];
  EXPECT_EQ(read.ledger.lost, 1U);
  EXPECT_EQ(read.returns, whole_.returns - returnsOf(5));
}

}  // namespace
}  // namespace perception
