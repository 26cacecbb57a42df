#include "libperception/packets/lidars/Ouster.h"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "tests/packets/Recorded.h"

namespace perception {
namespace {

template <class T>
std::string md5(const std::vector<T>& values) {
  unsigned char digest[16];
  EVP_Digest(values.data(), values.size() * sizeof(T), digest, nullptr, EVP_md5(), nullptr);
  std::string hex;
  for (const unsigned char byte : digest) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  return hex;
}

/// Fields of one frame, row by row.
struct Frame {
  explicit Frame(std::size_t size)
      : range{std::vector<std::uint32_t>(size), std::vector<std::uint32_t>(size)},
        signal{std::vector<std::uint16_t>(size), std::vector<std::uint16_t>(size)},
        reflectivity{std::vector<std::uint8_t>(size), std::vector<std::uint8_t>(size)},
        near_infrared(size) {}
  std::vector<std::uint32_t> range[2];
  std::vector<std::uint16_t> signal[2];
  std::vector<std::uint8_t> reflectivity[2];
  std::vector<std::uint16_t> near_infrared;
};

std::string ouster(const std::string& name) { return recordedFolder() + "ouster/" + name; }

Frame frameOf(const std::string& name, const OusterMetadata& metadata) {
  Frame frame(metadata.altitudes.size() * metadata.columns_per_frame);
  for (const UdpPacket& udp : readPcap(ouster(name + ".pcap")).packets) {
    if (udp.port != 7502) continue;
    std::vector<std::string> warnings;
    for (const OusterColumn& column : ousterColumns(udp.payload, metadata, warnings)) {
      for (std::size_t i = 0; column.valid && i < column.pixels.size(); ++i) {
        const std::size_t at = i * metadata.columns_per_frame + column.measurement;
        const OusterPixel& pixel = column.pixels[i];
        for (int k = 0; k < 2; ++k) {
          frame.range[k][at] = pixel.range[k];
          frame.signal[k][at] = pixel.signal[k];
          frame.reflectivity[k][at] = pixel.reflectivity[k];
        }
        frame.near_infrared[at] = pixel.near_infrared;
      }
    }
    EXPECT_TRUE(warnings.empty());
  }
  return frame;
}

TEST(Ouster, FieldsOfAFrameHaveTheMakersDigests) {
  SKIP_WITHOUT_RECORDINGS();
  for (const std::string name : {"OS-1-32-G_v2.1.1_1024x10", "OS-0-32-U1_v2.2.0_1024x10"}) {
    const OusterMetadata metadata = readOusterMetadata(ouster(name + ".json"));
    const Frame frame = frameOf(name, metadata);
    const auto digests = nlohmann::json::parse(readPossiblyGzipped(ouster(name + "_digest.json")));
    const auto& expected = digests["scans"][0];
    EXPECT_EQ(md5(frame.range[0]), expected["RANGE"]) << name;
    EXPECT_EQ(md5(frame.signal[0]), expected["SIGNAL"]) << name;
    EXPECT_EQ(md5(frame.reflectivity[0]), expected["REFLECTIVITY"]) << name;
    EXPECT_EQ(md5(frame.near_infrared), expected["NEAR_IR"]) << name;
    if (!expected.contains("RANGE2")) continue;
    EXPECT_EQ(md5(frame.range[1]), expected["RANGE2"]) << name;
    EXPECT_EQ(md5(frame.signal[1]), expected["SIGNAL2"]) << name;
    EXPECT_EQ(md5(frame.reflectivity[1]), expected["REFLECTIVITY2"]) << name;
  }
}

TEST(Ouster, ChecksumsAreCheckedWhereThereAreAny) {
  SKIP_WITHOUT_RECORDINGS();
  const OusterMetadata metadata = readOusterMetadata(ouster("crc_test.json"));
  int checked = 0;
  for (UdpPacket udp : readPcap(ouster("crc_test.pcap")).packets) {
    std::vector<std::string> warnings;
    if (udp.payload.size() < 8000) continue;
    ousterColumns(udp.payload, metadata, warnings);
    EXPECT_TRUE(warnings.empty());
    udp.payload[5000] = static_cast<char>(udp.payload[5000] ^ 1);
    ousterColumns(udp.payload, metadata, warnings);
    EXPECT_EQ(warnings.size(), 1U);
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

TEST(Ouster, RefusesMetadataThatCannotBe) {
  EXPECT_THROW(parseOusterMetadata("{", "x"), DataError);
  EXPECT_THROW(parseOusterMetadata("[]", "x"), DataError);
  SKIP_WITHOUT_RECORDINGS();
  for (const char* name : {"complete_but_all_zeros_legacy", "incorrect_nbeam_angles_legacy_113",
                           "incomplete_data_format_legacy", "incomplete_data_format_nonlegacy"}) {
    EXPECT_THROW(readOusterMetadata(ouster(std::string("malformed/") + name + ".json")), DataError)
        << name;
  }
}

}  // namespace
}  // namespace perception
