#include "libperception/interop/bags/McapWriter.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace perception {
namespace {

std::uint64_t numberAt(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, size);
  return value;
}

std::uint64_t crcOf(const std::string& bytes, std::size_t begin, std::size_t end) {
  return crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()) + begin,
               static_cast<unsigned>(end - begin));
}

// A file with one message, as bytes.
std::string fileOfOneMessage() {
  const std::string path = testing::TempDir() + "one.mcap";
  McapWriter writer(path);
  writer.write(writer.addChannel("/a", "json", {"x.Y", "jsonschema", "{}"}), Stamp{7}, "{\"z\":1}");
  writer.close();
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::filesystem::remove(path);
  return bytes;
}

TEST(McapWriter, ChecksumsOfDataAndSummaryCoverWhatTheSpecificationSays) {
  const std::string bytes = fileOfOneMessage();
  const std::size_t footer = bytes.size() - 8 - 20;
  const auto summary = static_cast<std::size_t>(numberAt(bytes, footer, 8));
  EXPECT_EQ(numberAt(bytes, footer + 16, 4), crcOf(bytes, summary, footer + 16));
  const std::size_t data_end = summary - 13;
  EXPECT_EQ(bytes[data_end], 15);
  EXPECT_EQ(numberAt(bytes, data_end + 9, 4), crcOf(bytes, 0, data_end));
}

TEST(McapWriter, BeginsAndEndsWithTheMagic) {
  const std::string bytes = fileOfOneMessage(), magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(bytes.substr(0, 8), magic);
  EXPECT_EQ(bytes.substr(bytes.size() - 8), magic);
  EXPECT_NE(bytes.find("{\"z\":1}"), std::string::npos);
}

}  // namespace
}  // namespace perception
