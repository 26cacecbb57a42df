// Recordings of ROS 2 in sqlite, written here as rosbag2 lays them out, from messages of an MCAP
// file.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosSensors.h"
#include "tests/importers/ImportFixture.h"
#include "tests/importers/bags/ZstdFrame.h"

namespace perception {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// A database that the test writes.
class WrittenDatabase {
 public:
  explicit WrittenDatabase(const std::string& path) {
    EXPECT_EQ(sqlite3_open(path.c_str(), &db_), SQLITE_OK);
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
        "INTEGER NOT NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  }
  ~WrittenDatabase() { sqlite3_close(db_); }
  WrittenDatabase(const WrittenDatabase&) = delete;
  WrittenDatabase& operator=(const WrittenDatabase&) = delete;
  void run(const std::string& sql) {
    char* what = nullptr;
    EXPECT_EQ(sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, &what), SQLITE_OK) << what;
  }
  void topic(int id, const std::string& name, const std::string& type,
             const std::string& encoding = "cdr") {
    run("INSERT INTO topics VALUES(" + std::to_string(id) + ", '" + name + "', '" + type + "', '" +
        encoding + "', '')");
  }
  void message(int topic, std::int64_t stamp, const std::string& bytes) {
    sqlite3_stmt* row = nullptr;
    sqlite3_prepare_v2(db_, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1,
                       &row, nullptr);
    sqlite3_bind_int(row, 1, topic);
    sqlite3_bind_int64(row, 2, stamp);
    sqlite3_bind_blob(row, 3, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(row), SQLITE_DONE);
    sqlite3_finalize(row);
  }

 private:
  sqlite3* db_ = nullptr;
};

/// A vehicle that drives 2 m in a second, with a lidar 1.8 m above the ground.
class SqliteBag : public test::ImportRun {
 protected:
  using Change = std::function<std::string(const std::string&)>;

  void SetUp() override { writeMcap(20); }
  void writeMcap(int scans) {
    McapWriter writer(file("drive.mcap"), "ros2");
    const auto cdr = ros::Encoding::kCdr;
    const auto fixed = writer.addChannel("/tf_static", "cdr", {"tf2_msgs/msg/TFMessage", "", ""});
    const auto moving = writer.addChannel("/tf", "cdr", {"tf2_msgs/msg/TFMessage", "", ""});
    const auto points =
        writer.addChannel("/points", "cdr", {"sensor_msgs/msg/PointCloud2", "", ""});
    const auto place = [](std::int64_t stamp, const std::string& parent, const std::string& child,
                          const std::array<double, 3>& at) {
      return ros::TFMessage{{{{Stamp{stamp}, parent}, child, {at, {}}}}};
    };
    writer.write(fixed, Stamp{100 * kSecond},
                 ros::encoded(place(100 * kSecond, "base_link", "lidar", {0.5, 0, 1.8}), cdr));
    for (int k = 0; k < scans; ++k) {
      const std::int64_t stamp = (100 + k) * kSecond;
      writer.write(moving, Stamp{stamp},
                   ros::encoded(place(stamp, "map", "base_link", {2.0 * k, 0, 0}), cdr));
      LidarCloud cloud;
      for (int i = 0; i < 200; ++i) {
        cloud.x.push_back(10 + 0.1F * static_cast<float>(i));
        cloud.y.push_back(static_cast<float>(k));
        cloud.z.push_back(-1.5F);
        cloud.intensity.push_back(0.25F);
      }
      std::string data;
      writer.write(
          points, Stamp{stamp},
          ros::encoded(ros::messageOf(cloud, ros::Header{Stamp{stamp}, "lidar"}, data), cdr));
    }
    writer.close();
  }
  /// The MCAP file's messages from `first` to before `last`, as a database.
  void writeDb3(const std::string& name, const Change& change = {}, int first = 0,
                int last = 1000) {
    std::filesystem::create_directories(std::filesystem::path(file(name)).parent_path());
    WrittenDatabase db(file(name));
    db.run("BEGIN");
    copyTo(db, change, first, last);
    db.run("COMMIT");
  }
  void copyTo(WrittenDatabase& db, const Change& change = {}, int first = 0, int last = 1000) {
    db.topic(1, "/tf_static", "tf2_msgs/msg/TFMessage");
    db.topic(2, "/tf", "tf2_msgs/msg/TFMessage");
    db.topic(3, "/points", "sensor_msgs/msg/PointCloud2");
    const auto bag = openBag(file("drive.mcap"));
    BagMessage m;
    for (int i = 0; bag->next(m); ++i) {
      if (i < first || i >= last) continue;
      const int topic = m.topic->name == "/tf_static" ? 1 : m.topic->name == "/tf" ? 2 : 3;
      const std::string bytes(m.bytes);
      db.message(topic, m.stamp.ns, change ? change(bytes) : bytes);
    }
  }
  std::string content(const std::string& name) const {
    std::ostringstream bytes;
    bytes << std::ifstream(file(name), std::ios::binary).rdbuf();
    return bytes.str();
  }
  /// The log of an import that ends with `code`.
  std::string logOf(const std::string& name, int code = 0) {
    std::filesystem::remove(file("out.rawlog"));
    EXPECT_EQ(import("bag", {"--bag", file(name)}), code) << error_;
    return content("out.rawlog");
  }
  void expectNothing(const std::string& name) {
    std::filesystem::remove(file("out.rawlog"));
    expectFault(65, name, "bag", {"--bag", file(name)});
  }
  std::string logOfMcap() { return logOf("drive.mcap"); }
};

TEST_F(SqliteBag, GivesTheLogOfTheSameDriveInMcap) {
  writeDb3("drive.db3");
  const std::string log = logOfMcap();
  EXPECT_EQ(framesOf("points").size(), 20U);
  EXPECT_TRUE(logOf("drive.db3") == log);
  EXPECT_EQ(framesOf("points").size(), 20U);
}

TEST_F(SqliteBag, AFolderOfSeveralFilesIsOneRecordingInTheOrderOfTheirNumbers) {
  const std::string log = logOfMcap();
  // 41 messages; as text, 10 would come before 2.
  for (int i = 0; i < 11; ++i)
    writeDb3("run/run_" + std::to_string(i) + ".db3", {}, 4 * i, 4 * i + 4);
  write("run/metadata.yaml",
        "rosbag2_bagfile_information:\n  version: 5\n  topics_with_message_count:\n    - "
        "topic_metadata:\n        name: /points\n      message_count: 20\n  message_count: 41\n");
  EXPECT_TRUE(logOf("run") == log);
}

TEST_F(SqliteBag, AFolderWithoutItsMetadataIsReadAndSaidToBeUnfinished) {
  const std::string log = logOfMcap();
  writeDb3("run/run_0.db3");
  EXPECT_TRUE(logOf("run", 3) == log);
  EXPECT_NE(error_.find("no metadata.yaml"), std::string::npos) << error_;
}

TEST_F(SqliteBag, FewerMessagesThanTheMetadataCountsAreSaid) {
  writeDb3("run/run_0.db3");
  write("run/metadata.yaml", "rosbag2_bagfile_information:\n  message_count: 45\n");
  logOf("run", 3);
  EXPECT_NE(error_.find("45 messages by its metadata.yaml, but 41"), std::string::npos) << error_;
}

TEST_F(SqliteBag, CompressionByMessageAndByFileGiveTheSame) {
  const std::string log = logOfMcap();
  writeDb3("messages.db3", [](const std::string& bytes) { return zstdOf(bytes); });
  EXPECT_TRUE(logOf("messages.db3") == log);
  writeDb3("drive.db3");
  const std::string file = zstdOf(content("drive.db3"));
  write("drive.db3.zstd", file);
  EXPECT_TRUE(logOf("drive.db3.zstd") == log);
  write("drive.mcap.zstd", zstdOf(content("drive.mcap")));
  EXPECT_TRUE(logOf("drive.mcap.zstd") == log);
  // A player leaves both.
  write("both/drive.db3", content("drive.db3"));
  write("both/drive.db3.zstd", file);
  write("both/metadata.yaml", "");
  EXPECT_TRUE(logOf("both") == log);
}

TEST_F(SqliteBag, ATornCompressedFileIsReadAsFarAsItGoes) {
  writeMcap(60);
  writeDb3("drive.db3");
  const std::string file = zstdOf(content("drive.db3"));
  write("torn.db3.zstd", file.substr(0, file.size() - 100));
  logOf("torn.db3.zstd", 3);
  EXPECT_NE(error_.find("torn.db3.zstd: the zstd data end early"), std::string::npos) << error_;
  EXPECT_GT(framesOf("points").size(), 10U);
  write("head.db3.zstd", file.substr(0, 8));
  expectNothing("head.db3.zstd");
}

TEST_F(SqliteBag, ADamagedCompressedMessageCostsItselfAlone) {
  int n = 0;
  writeDb3("messages.db3", [&n](const std::string& bytes) {
    std::string out = zstdOf(bytes);
    return ++n == 41 ? out.substr(0, out.size() / 2) : out;
  });
  logOf("messages.db3", 3);
  EXPECT_NE(error_.find("row 41: a compressed message of /points"), std::string::npos) << error_;
  EXPECT_EQ(framesOf("points").size(), 19U);
}

TEST_F(SqliteBag, ACutFileIsReadAsFarAsItGoes) {
  writeDb3("drive.db3");
  const std::string whole = content("drive.db3");
  write("cut.db3", whole.substr(0, whole.size() * 6 / 10));
  logOf("cut.db3", 3);
  EXPECT_NE(error_.find("cut.db3: behind row"), std::string::npos) << error_;
  const auto frames = framesOf("points");
  EXPECT_GT(frames.size(), 5U);
  EXPECT_LT(frames.size(), 20U);
}

TEST_F(SqliteBag, RowsBehindADamagedPageAreFound) {
  writeMcap(60);
  writeDb3("drive.db3");
  std::string bytes = content("drive.db3");
  // Pages of 4096 bytes; a scan of 200 points takes most of one.
  for (std::size_t i = 0; i < 4096; ++i) bytes[bytes.size() / 2 / 4096 * 4096 + i] = '\xff';
  write("hole.db3", bytes);
  logOf("hole.db3", 3);
  const auto frames = framesOf("points");
  EXPECT_GT(frames.size(), 40U);
  EXPECT_LT(frames.size(), 60U);
  EXPECT_EQ(frames.back().stamp.ns, 159 * kSecond);
}

TEST_F(SqliteBag, AWriteAheadLogBesideTheFileIsReadAndNeitherIsChanged) {
  const std::string log = logOfMcap();
  {
    WrittenDatabase db(file("live.db3"));
    db.run("PRAGMA journal_mode = WAL");
    copyTo(db);
    // As a recorder leaves them that is killed: both copied while they are open.
    write("killed.db3", content("live.db3"));
    write("killed.db3-wal", content("live.db3-wal"));
  }
  const std::string before = content("killed.db3"), wal = content("killed.db3-wal");
  ASSERT_GT(wal.size(), before.size());
  EXPECT_TRUE(logOf("killed.db3", 3) == log);
  EXPECT_NE(error_.find("killed.db3-wal is beside it"), std::string::npos) << error_;
  EXPECT_TRUE(content("killed.db3") == before);
  EXPECT_TRUE(content("killed.db3-wal") == wal);
  EXPECT_FALSE(std::filesystem::exists(file("killed.db3-shm")));
}

TEST_F(SqliteBag, AJournalBesideTheFileIsSaidAndLeftAlone) {
  writeDb3("drive.db3");
  const std::string log = logOf("drive.db3");
  write("drive.db3-journal", std::string(512, '\0'));
  EXPECT_TRUE(logOf("drive.db3") == log);
  write("drive.db3-journal", "\xd9\xd5\x05\xf9 \xa1\x63\xd7 and more");
  EXPECT_TRUE(logOf("drive.db3", 3) == log);
  EXPECT_NE(error_.find("drive.db3-journal is beside it"), std::string::npos) << error_;
  EXPECT_TRUE(std::filesystem::exists(file("drive.db3-journal")));
}

TEST_F(SqliteBag, ADatabaseOfSomethingElseIsRefused) {
  { WrittenDatabase(file("other.db3")).run("DROP TABLE messages"); }
  expectFault(65, "without the tables topics and messages", "bag", {"--bag", file("other.db3")});
}

TEST_F(SqliteBag, ChangedBytesAreSaidAndNeverFollowed) {
  writeMcap(5);
  writeDb3("drive.db3");
  const std::string whole = content("drive.db3");
  Rng rng({2, 0, 0, 0});
  int read = 0, said = 0;
  for (int i = 0; i < 100; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 4; ++k) {
      const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(whole.size()));
      damaged[at] = static_cast<char>(256 * rng.uniform());
    }
    write("damaged.db3", damaged);
    const int code = import("bag", {"--bag", file("damaged.db3")});
    EXPECT_TRUE(code == 0 || code == 3 || code == 65 || code == 66) << code << error_;
    read += code == 0 || code == 3;
    said += code != 0;
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(said, 5);
}

}  // namespace
}  // namespace perception
