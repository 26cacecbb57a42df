#include "libperception/sensors/rawlog/RawlogReader.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/version.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <random>

#include "libperception/core/Error.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;
using End = RawlogReader::End;

/// The bytes of a gzip file, inflated.
std::string inflated(const std::string& path) {
  const gzFile file = gzopen(path.c_str(), "rb");
  std::string bytes;
  char part[4096];
  for (int got = 0; (got = gzread(file, part, sizeof(part))) > 0;) {
    bytes.append(part, static_cast<std::size_t>(got));
  }
  gzclose(file);
  return bytes;
}

/// Opens and expects a DataError; gives its code and message.
std::pair<ExitCode, std::string> refusal(const std::string& path) {
  try {
    RawlogReader reader(path);
  } catch (const DataError& e) {
    return {e.code(), e.what()};
  }
  return {ExitCode::kOk, "opened"};
}

class RawlogReaderTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string log_ = folder_ / "a.rawlog";
};

TEST_F(RawlogReaderTest, GivesEveryObservationOfAWholeLog) {
  writeLog(log_, 10);
  RawlogReader reader(log_);
  std::size_t scans = 0, frames = 0;
  while (const auto o = reader.next()) {
    if (std::dynamic_pointer_cast<CObservationLidarScan>(o)) ++scans;
    if (const auto number = frameNumber(*o)) {
      EXPECT_EQ(*number, static_cast<std::int64_t>(frames++));
    }
  }
  EXPECT_EQ(scans, 10U);
  EXPECT_EQ(frames, 10U);
  EXPECT_EQ(reader.end(), End::kClean) << reader.endMessage();
  EXPECT_EQ(reader.entries(), 50U);
  EXPECT_EQ(reader.lastStamp()->ns, (kStart + 0.9).ns);
  EXPECT_EQ(reader.bytesRead(), reader.fileBytes());
  EXPECT_EQ(reader.next(), nullptr);
}

TEST_F(RawlogReaderTest, HandsOnTheBytesOfTheFile) {
  writeLog(log_, 10);
  std::string bytes;
  RawlogReader reader(log_, [&](const unsigned char* part, std::size_t count) {
    bytes.append(part, part + count);
  });
  drain(reader);
  EXPECT_EQ(bytes, readBytes(log_));
}

TEST_F(RawlogReaderTest, ReadsPlainFilesAndSeveralGzipMembers) {
  writeLog(log_, 3);
  const std::string plain = folder_ / "plain.rawlog", twice = folder_ / "twice.rawlog";
  writeBytes(plain, inflated(log_));
  writeBytes(twice, readBytes(log_) + readBytes(log_));
  RawlogReader plain_reader(plain), twice_reader(twice);
  EXPECT_EQ(drain(plain_reader), 15U);
  EXPECT_EQ(plain_reader.end(), End::kClean);
  EXPECT_EQ(drain(twice_reader), 30U);
  EXPECT_EQ(twice_reader.end(), End::kClean) << twice_reader.endMessage();
}

TEST_F(RawlogReaderTest, FlattensSensoryFramesAndOdometryOfActions) {
  {
    RawlogWriter log(log_);
    mrpt::obs::CActionCollection actions;
    mrpt::obs::CActionRobotMovement2D move;
    move.rawOdometryIncrementReading = mrpt::poses::CPose2D(1, 0, 0);
    move.timestamp = fromStamp(kStart);
    actions.insert(move);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(fullScan(5));
    frame.insert(someDetections());
    for (int i = 0; i < 3; ++i) {
      log.write(actions);
      log.write(frame);
    }
    log.close();
  }
  RawlogReader reader(log_);
  std::vector<double> odometry;
  std::size_t all = 0;
  while (const auto o = reader.next()) {
    ++all;
    if (const auto* odo = dynamic_cast<const mrpt::obs::CObservationOdometry*>(o.get())) {
      odometry.push_back(odo->odometry.x());
    }
  }
  EXPECT_EQ(all, 9U);
  EXPECT_EQ(odometry, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(reader.entries(), 6U);
  EXPECT_EQ(reader.end(), End::kClean);
}

TEST_F(RawlogReaderTest, ASensorWithoutALabelHasTheNameOfItsClass) {
  {
    RawlogWriter log(log_);
    mrpt::obs::CObservation2DRangeScan scan;
    scan.timestamp = fromStamp(kStart);
    log.write(scan);
    mrpt::obs::CObservationComment comment;
    comment.timestamp = fromStamp(kStart);
    log.write(comment);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(std::make_shared<mrpt::obs::CObservation2DRangeScan>(scan));
    log.write(frame);
    log.close();
  }
  RawlogReader reader(log_);
  EXPECT_EQ(reader.next()->sensorLabel, "CObservation2DRangeScan");
  EXPECT_EQ(reader.next()->sensorLabel, "");  // no sensor
  EXPECT_EQ(reader.next()->sensorLabel, "CObservation2DRangeScan");
}

TEST_F(RawlogReaderTest, EveryCutOfAGzipLogIsTorn) {
  writeLog(log_, 2, 1, 30);
  const std::string whole = readBytes(log_);
  RawlogReader complete(log_);
  const std::size_t all = drain(complete);
  std::size_t last_count = 0;
  for (std::size_t size = 3; size < whole.size(); size += size < 40 ? 1 : 7) {
    writeBytes(folder_ / "cut", whole.substr(0, size));
    RawlogReader reader(folder_ / "cut");
    const std::size_t count = drain(reader);
    EXPECT_EQ(reader.end(), End::kTorn) << size << ": " << reader.endMessage();
    EXPECT_GE(count, last_count) << size;
    last_count = count;
  }
  writeBytes(folder_ / "cut", whole.substr(0, whole.size() - 1));
  RawlogReader reader(folder_ / "cut");
  EXPECT_EQ(drain(reader), all);  // all entries are there, but the container's trailer is not
  EXPECT_EQ(reader.end(), End::kTorn);
}

TEST_F(RawlogReaderTest, EveryCutOfAPlainLogIsTornUnlessBetweenEntries) {
  std::vector<std::size_t> boundaries;
  {
    RawlogWriter log(log_);
    const std::shared_ptr<mrpt::obs::CObservation> entries[] = {
        frameComment(kStart, 0), fullScan(3), someDetections(), someReturns()};
    for (const auto& entry : entries) {
      log.write(*entry);
      boundaries.push_back(log.bytesInflated());
    }
    log.close();
  }
  const std::string whole = inflated(log_);
  ASSERT_EQ(whole.size(), boundaries.back());
  const auto endOfCut = [&](std::size_t size, std::size_t entries) {
    writeBytes(folder_ / "cut", whole.substr(0, size));
    RawlogReader reader(folder_ / "cut");
    EXPECT_EQ(drain(reader), entries) << size;
    return reader.end();
  };
  // MRPT's exceptions carry a call stack and take milliseconds: not every single byte.
  for (std::size_t size = 1; size < whole.size(); size += 5) {
    const auto next = std::lower_bound(boundaries.begin(), boundaries.end(), size);
    if (*next != size) {
      EXPECT_EQ(endOfCut(size, static_cast<std::size_t>(next - boundaries.begin())), End::kTorn);
    }
  }
  for (std::size_t k = 0; k < boundaries.size(); ++k) {
    EXPECT_EQ(endOfCut(boundaries[k] - 1, k), End::kTorn);
    EXPECT_EQ(endOfCut(boundaries[k], k + 1), End::kClean);
  }
}

TEST_F(RawlogReaderTest, TornMessageNamesPlaceEntryAndStamp) {
  writeLog(log_, 4);
  const std::string whole = inflated(log_);
  writeBytes(folder_ / "cut", whole.substr(0, whole.size() - 50));
  RawlogReader reader(folder_ / "cut");
  EXPECT_EQ(drain(reader), 19U);
  EXPECT_NE(reader.endMessage().find("cut: the file ends inside an entry; entry 19 at byte "),
            std::string::npos)
      << reader.endMessage();
  EXPECT_NE(reader.endMessage().find("last stamp 1317038400.300000"), std::string::npos)
      << reader.endMessage();
}

TEST_F(RawlogReaderTest, NoBitFlipPassesAsAWholeGzipLog) {
  writeLog(log_, 3, 1, 100);
  const std::string whole = readBytes(log_), content = inflated(log_);
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    std::string bytes = whole;
    // Behind the ten bytes of gzip's header, which carry no data.
    const std::size_t at = 10 + random() % (bytes.size() - 10);
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
    writeBytes(folder_ / "flip", bytes);
    try {
      RawlogReader reader(folder_ / "flip");
      drain(reader);
      // Some bits may stand either way: a copy from another place where the same bytes are.
      const bool clean = reader.end() == End::kClean;
      EXPECT_TRUE(!clean || inflated(folder_ / "flip") == content) << "byte " << at;
    } catch (const DataError&) {  // the first entry is hit
    }
  }
}

TEST_F(RawlogReaderTest, SomethingAppendedIsDamage) {
  writeLog(log_, 2);
  writeBytes(log_, readBytes(log_) + "appended");
  RawlogReader reader(log_);
  EXPECT_EQ(drain(reader), 10U);
  EXPECT_EQ(reader.end(), End::kDamaged);
  const std::string plain = folder_ / "plain";
  writeLog(log_, 2);
  writeBytes(plain, inflated(log_) + "appended");
  RawlogReader plain_reader(plain);
  EXPECT_EQ(drain(plain_reader), 10U);
  EXPECT_EQ(plain_reader.end(), End::kDamaged);
}

/// The log of three frames with the class name or version of its n-th lidar scan changed.
std::string changedScan(const std::string& bytes, int nth, bool version) {
  const std::string name = "perception::CObservationLidarScan";
  std::size_t at = 0;
  for (int i = 0; i <= nth; ++i) at = bytes.find(name, at + 1);
  std::string changed = bytes;
  if (version) {
    changed[at + name.size()] = 99;
  } else {
    changed[at + name.size() - 1] = 'X';
  }
  return changed;
}

TEST_F(RawlogReaderTest, UnknownClassIsNamedWithTheRemedy) {
  writeLog(log_, 3);
  writeBytes(folder_ / "x", changedScan(inflated(log_), 1, false));
  RawlogReader reader(folder_ / "x");
  EXPECT_EQ(drain(reader), 7U);
  EXPECT_EQ(reader.end(), End::kUnknownClass);
  EXPECT_NE(reader.endMessage().find("'perception::CObservationLidarScaX'"), std::string::npos);
  EXPECT_NE(reader.endMessage().find("link or load the library that registers it (plugin)"),
            std::string::npos);
}

TEST_F(RawlogReaderTest, UnknownClassInsideASensoryFrameIsNamed) {
  {
    RawlogWriter log(log_);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(fullScan(5));
    log.write(frame);
    log.close();
  }
  writeBytes(folder_ / "x", changedScan(inflated(log_), 0, false));
  RawlogReader reader(folder_ / "x");
  EXPECT_EQ(drain(reader), 0U);
  EXPECT_EQ(reader.end(), End::kUnknownClass) << reader.endMessage();
  EXPECT_NE(reader.endMessage().find("'perception::CObservationLidarScaX'"), std::string::npos);
}

TEST_F(RawlogReaderTest, NewerVersionIsToldApartFromDamage) {
  writeLog(log_, 3);
  writeBytes(folder_ / "x", changedScan(inflated(log_), 2, true));
  RawlogReader reader(folder_ / "x");
  EXPECT_EQ(drain(reader), 12U);
  EXPECT_EQ(reader.end(), End::kNewerVersion) << reader.endMessage();
}

TEST_F(RawlogReaderTest, WhatIsNoRawlogIsRefusedWithWhatItIs) {
  EXPECT_EQ(refusal(folder_ / "none").first, ExitCode::kNoInput);
  writeBytes(folder_ / "empty", "");
  EXPECT_EQ(refusal(folder_ / "empty").first, ExitCode::kBadInput);
  EXPECT_NE(refusal(folder_ / "empty").second.find("empty file"), std::string::npos);
  EXPECT_EQ(refusal(folder_.path()).first, ExitCode::kBadInput);
  EXPECT_NE(refusal(folder_.path()).second.find("a directory"), std::string::npos);
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_NE(refusal(folder_ / "pipe").second.find("a pipe"), std::string::npos);
  writeBytes(folder_ / "text", "frame,t,id\n1,2,3\n");
  EXPECT_NE(refusal(folder_ / "text").second.find("text that begins with \"frame,t,id\""),
            std::string::npos);
  writeBytes(folder_ / "binary", std::string("\x89PNG\r\n\x1a\n\0\0\0", 11));
  EXPECT_NE(refusal(folder_ / "binary").second.find("89 50 4e 47"), std::string::npos);
  writeBytes(folder_ / "zeros", std::string(1000, '\0'));
  EXPECT_EQ(refusal(folder_ / "zeros").first, ExitCode::kBadInput);
}

TEST_F(RawlogReaderTest, EmptyGzipLogIsRefused) {
  { RawlogWriter(log_).close(); }
  EXPECT_EQ(refusal(log_).first, ExitCode::kBadInput);
  EXPECT_NE(refusal(log_).second.find("without a single entry"), std::string::npos);
}

TEST_F(RawlogReaderTest, RandomMutationsOfAPlainLogEndWithAReason) {
  writeLog(log_, 2, 1, 40);
  const std::string whole = inflated(log_);
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    std::string bytes = whole;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    writeBytes(folder_ / "m", bytes);
    try {
      RawlogReader reader(folder_ / "m");
      drain(reader);
      EXPECT_NE(reader.end(), End::kNotYet);
      EXPECT_FALSE(reader.endMessage().empty());
    } catch (const DataError&) {
    }
  }
}

// MRPT 2.14 writes a byte more of CObservationRotatingScan than MRPT 2.5, before the ranges, and no
// new version number tells it.
TEST_F(RawlogReaderTest, ATurnOfAnotherMrptIsRefusedWithTheCause) {
  mrpt::obs::CObservationRotatingScan turn;
  turn.timestamp = mrpt::Clock::fromDouble(1.4e9);
  turn.sensorLabel = "LIDAR";
  turn.rowCount = 16, turn.columnCount = 1800;
  turn.rangeImage.setConstant(16, 1800, 500);
  turn.intensityImage.setConstant(16, 1800, 20);
  {
    RawlogWriter log(log_);
    log.write(turn);
    log.close();
  }
  std::string bytes = inflated(log_);
  const std::size_t sizes = bytes.find(std::string("\x08\x07\x10\x00", 4), 60);  // 1800 by 16
  ASSERT_NE(sizes, std::string::npos);
  writeBytes(folder_ / "own", bytes);
  RawlogReader own(folder_ / "own");
  EXPECT_EQ(drain(own), 1U);
  EXPECT_EQ(own.end(), End::kClean);
  writeBytes(folder_ / "other", bytes.insert(sizes, 1, '\0'));
  RawlogReader other(folder_ / "other");
  EXPECT_EQ(drain(other), 0U);
  EXPECT_EQ(other.end(), End::kTorn);  // it asks for more bytes than there are
  EXPECT_NE(other.endMessage().find("the version of MRPT that wrote it"), std::string::npos)
      << other.endMessage();
}

TEST(RawlogReader, ReadsRealLogsOfMrpt) {
  const std::string dir = std::string(PERCEPTION_SHARED_DATA) + "/data/mrpt_samples/";
  if (!std::filesystem::exists(dir)) GTEST_SKIP() << "no recordings at " << dir;
  const std::pair<const char*, std::size_t> logs[] = {
      {"test_velodyne_VLP16.rawlog", 1},
      {"rot_scan_velodyne.rawlog", 1},
      {"test_rtk_path.rawlog", 100},
      {"2006-01ENE-21-SENA_Telecom_Faculty_one_loop_only.rawlog", 100}};
  for (const auto& [name, least] : logs) {
    // Written by MRPT 2.5 (see ATurnOfAnotherMrptIsRefusedWithTheCause).
    if (MRPT_VERSION >= 0x020e00 && std::string(name) == "rot_scan_velodyne.rawlog") continue;
    RawlogReader reader(dir + name);
    EXPECT_GE(drain(reader), least) << name;
    EXPECT_EQ(reader.end(), End::kClean) << reader.endMessage();
  }
}

}  // namespace
}  // namespace perception
