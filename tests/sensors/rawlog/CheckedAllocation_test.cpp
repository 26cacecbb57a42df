#include "libperception/sensors/rawlog/CheckedAllocation.h"

#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdlib>
#include <cstring>

#include "libperception/core/system/MemoryLimit.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

constexpr std::uint64_t kGigabyte = 1ULL << 30;

/// An uncompressed log of one cloud with five points, their number replaced by `count`.
void writeForgedLog(const std::string& file, std::uint32_t count) {
  mrpt::obs::CObservationPointCloud cloud;
  cloud.timestamp = fromStamp(kStart);
  cloud.sensorLabel = "L";
  auto points = std::make_shared<mrpt::maps::CSimplePointsMap>();
  for (int i = 0; i < 5; ++i) points->insertPoint(1.F, 2.F, static_cast<float>(i));
  cloud.pointcloud = points;
  mrpt::io::CFileOutputStream out(file);
  auto archive = mrpt::serialization::archiveFrom(out);
  archive << cloud;
  out.close();
  // The number stands before the first x, 1.0F.
  std::string bytes = readBytes(file);
  const char before[] = {5, 0, 0, 0, 0, 0, '\x80', '\x3f'};
  const auto at = bytes.find(std::string(before, sizeof before));
  ASSERT_NE(at, std::string::npos);
  std::memcpy(bytes.data() + at, &count, sizeof count);
  writeBytes(file, bytes);
}

// MRPT alone dies of these (its aligned allocator gives null, its vectors write to it).
TEST(CheckedAllocation, ForgedNumbersOfPointsEndTheLogAndNotTheProgram) {
  if (!MemoryLimit::supported()) GTEST_SKIP() << "sanitizers reserve terabytes";
  const TemporaryFolder folder;
  const std::string file = folder / "forged.rawlog";
  for (const std::uint32_t count : {6U, 100'000'000U, 0x3fffffffU, 0xffffffffU}) {
    writeForgedLog(file, count);
    EXPECT_EXIT(
        {
          const MemoryLimit limit(2 * kGigabyte);
          RawlogReader reader(file);
          const bool none = reader.next() == nullptr;
          const bool said = reader.end() == RawlogReader::End::kDamaged ||
                            reader.end() == RawlogReader::End::kTorn;
          std::exit(none && said ? 7 : 8);
        },
        ::testing::ExitedWithCode(7), "")
        << count;
  }
  writeForgedLog(file, 5);
  RawlogReader whole(file);
  EXPECT_NE(whole.next(), nullptr);
}

}  // namespace
}  // namespace perception
