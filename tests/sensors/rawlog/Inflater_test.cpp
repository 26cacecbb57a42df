#include "libperception/sensors/rawlog/Inflater.h"

#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;
using End = RawlogReader::End;

std::string withoutGzip(const std::string& path) {
  const gzFile file = gzopen(path.c_str(), "rb");
  std::string bytes(1 << 22, '\0');
  bytes.resize(static_cast<std::size_t>(gzread(file, bytes.data(), 1 << 22)));
  gzclose(file);
  return bytes;
}

// One frame with a checksum, as zstd's stream writers make it.
std::string zstdOf(const std::string& bytes) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress2(context, out.data(), out.size(), bytes.data(), bytes.size()));
  ZSTD_freeCCtx(context);
  return out;
}

class ZstdLog : public ::testing::Test {
 protected:
  void SetUp() override {
    writeLog(folder_ / "a", 2, 1, 30);
    plain_ = withoutGzip(folder_ / "a");
    whole_ = zstdOf(plain_);
    ASSERT_LT(whole_.size(), plain_.size());
  }
  std::pair<std::size_t, End> entriesOf(const std::string& bytes) {
    writeBytes(folder_ / "z", bytes);
    RawlogReader reader(folder_ / "z");
    const std::size_t count = drain(reader);
    message_ = reader.endMessage();
    return {count, reader.end()};
  }
  TemporaryFolder folder_;
  std::string plain_, whole_, message_;
};

TEST_F(ZstdLog, IsReadLikeAGzipLog) {
  EXPECT_EQ(entriesOf(whole_), std::make_pair(std::size_t{10}, End::kClean)) << message_;
  const std::string skippable("\x50\x2A\x4D\x18\x03\0\0\0abc", 11);
  EXPECT_EQ(entriesOf(skippable + whole_ + whole_), std::make_pair(std::size_t{20}, End::kClean))
      << message_;
}

TEST_F(ZstdLog, EveryCutIsTornAndEveryChangedByteIsFound) {
  for (std::size_t size = 5; size < whole_.size(); size += 37) {
    EXPECT_EQ(entriesOf(whole_.substr(0, size)).second, End::kTorn) << size << message_;
  }
  EXPECT_NE(message_.find("zstd container"), std::string::npos) << message_;
  for (std::size_t at = whole_.size() / 3; at < whole_.size(); at += 211) {
    std::string changed = whole_;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    try {
      EXPECT_NE(entriesOf(changed).second, End::kClean) << at;
    } catch (const std::exception&) {  // already the first entry is unreadable
    }
  }
  EXPECT_EQ(entriesOf(whole_ + "abc").second, End::kDamaged);
  EXPECT_NE(message_.find("other data follow"), std::string::npos) << message_;
}

TEST(InflaterFor, LeavesPlainFilesAlone) {
  const unsigned char plain[] = {0x80 + 12, 'C', 'O', 'b'};
  EXPECT_EQ(inflaterFor(plain, 4), nullptr);
  EXPECT_EQ(inflaterFor(plain, 0), nullptr);
}

}  // namespace
}  // namespace perception
