#include "libperception/packets/Ars548.h"

#include <gtest/gtest.h>

#include <string>

#include "libperception/core/Error.h"

namespace perception {
namespace {

std::string detections(char count) {
  std::string bytes(35336, '\0');
  bytes[2] = 1, bytes[3] = 0x50;
  bytes[6] = static_cast<char>(0x8A), bytes[7] = 0;  // 35328
  bytes[35312] = count;
  return bytes;
}

TEST(Ars548, CountsAndReadsDetections) {
  std::string bytes = detections(2);
  bytes[101 + 44 + 17] = 0x41, bytes[101 + 44 + 18] = 0x20;  // 10.0f
  const Ars548Message message = decodeArs548(bytes);
  ASSERT_EQ(message.detections.size(), 2U);
  EXPECT_EQ(message.detections[1].range, 10.0F);
}

TEST(Ars548, RefusesWrongCountAndSize) {
  std::string bytes = detections(2);
  bytes[35309] = 1;
  EXPECT_THROW(decodeArs548(bytes), DataError);
  EXPECT_THROW(decodeArs548(std::string(60, '\0')), DataError);
  EXPECT_THROW(decodeArs548(""), DataError);
}

}  // namespace
}  // namespace perception
