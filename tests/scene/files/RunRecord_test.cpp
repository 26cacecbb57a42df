#include "libperception/scene/files/RunRecord.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

using namespace test;

RunRecord someRecord() {
  RunRecord r;
  r.program = "perception-track";
  r.version = "0.2.0";
  r.hash = "0123abcd";
  r.input = "recordings/of monday/crossing.rawlog";
  r.input_bytes = 123456;
  r.input_entries = 789;
  r.input_end = "torn";
  r.input_end_detail = "within the object at byte 123400";
  r.simulated = true;
  r.config = "ini/demo.ini";
  r.seed = 18446744073709551615u;
  r.sensors_used = "C+L";
  r.association = "sampled";
  r.particles = 50;
  r.first_stamp = kFirstStamp;
  r.last_stamp = Stamp{kFirstStamp.ns + 1};
  r.scenes = 100;
  r.tracks = 7;
  r.sensors = {{"LIDAR_TOP", "L", 100, 1500, 3, 0, 1}, {"CAMERA", "C", 100, 300, 0, 2, 0}};
  r.events = {{"track_born", 7}, {"dropped_points", 3}};
  r.warnings = {"the log is torn"};
  return r;
}

TEST(RunRecord, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  const RunRecord record = someRecord();
  writeRunRecord(folder / "done.json", record);
  const RunRecord read = readRunRecord(folder / "done.json");
  EXPECT_EQ(read.input, "crossing.rawlog");
  EXPECT_EQ(read.seed, record.seed);
  EXPECT_EQ(read.first_stamp, record.first_stamp);
  EXPECT_EQ(read.last_stamp, record.last_stamp);
  EXPECT_TRUE(read.simulated);
  EXPECT_EQ(toJson(read), toJson(record));
}

TEST(RunRecord, NamesFilesWithoutTheirFolders) {
  const std::string text = toJson(someRecord());
  EXPECT_EQ(text.find('/'), std::string::npos) << text;
  EXPECT_NE(text.find(R"("name": "crossing.rawlog")"), std::string::npos);
  EXPECT_NE(text.find(R"("config": "demo.ini")"), std::string::npos);
}

TEST(RunRecord, IsTheSameTextForTheSameRecord) {
  EXPECT_EQ(toJson(someRecord()), toJson(someRecord()));
  EXPECT_EQ(toJson(someRecord()).substr(0, 64),
            "{\n  \"program\": \"perception-track\",\n  \"version\": \"0.2.0\",\n  \"hash");
}

TEST(RunRecord, SaysWhatIsWrongWithAFileThatIsNone) {
  const TemporaryFolder folder;
  const auto codeAndMessage = [&](const std::string& text) {
    writeText(folder / "done.json", text);
    try {
      readRunRecord(folder / "done.json");
    } catch (const DataError& e) {
      return std::make_pair(e.code(), std::string(e.what()));
    }
    return std::make_pair(ExitCode::kOk, std::string());
  };
  for (const std::string text : {"", "{", "[]", "{}", "{\"program\": 3}"}) {
    const auto [code, message] = codeAndMessage(text);
    EXPECT_EQ(code, ExitCode::kBadInput) << text;
    EXPECT_NE(message.find("done.json: not a record of a run"), std::string::npos) << message;
  }
  std::string text = toJson(someRecord());
  text.replace(text.find("1700000000.123456789"), 20, "1700000000,123456789");
  EXPECT_NE(codeAndMessage(text).second.find("found '1700000000,123456789', expected seconds"),
            std::string::npos);
}

TEST(RunRecord, SaysThatAFileIsMissing) {
  const TemporaryFolder folder;
  try {
    readRunRecord(folder / "done.json");
    FAIL() << "read a file that is not there";
  } catch (const DataError& e) {
    EXPECT_EQ(e.code(), ExitCode::kNoInput);
  }
}

}  // namespace
}  // namespace perception
