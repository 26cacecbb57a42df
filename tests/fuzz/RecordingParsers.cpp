#include <sqlite3.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "tests/fuzz/ParserFiles.h"

namespace perception {
namespace {

/// A small recording in sqlite.
std::string database() {
  const std::string path = scratch() + "/seed.db3";
  sqlite3* db = nullptr;
  sqlite3_open(path.c_str(), &db);
  sqlite3_exec(db,
               "PRAGMA page_size = 512;"
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
               "serialization_format TEXT, offered_qos_profiles TEXT);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
               "data BLOB);"
               "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
               "INSERT INTO topics VALUES(1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr', '');"
               "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 60) "
               "INSERT INTO messages SELECT i, 1, i, zeroblob(20 * i) FROM n;",
               nullptr, nullptr, nullptr);
  sqlite3_close(db);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void takeMessage(const BagType& type, const BagTopic& topic, std::string_view bytes) {
  BagMessage message;
  message.topic = &topic;
  message.bytes = bytes;
  SensorFrame frame;
  ros::Header header;
  BagContents contents;
  std::vector<BagPacket> packets;
  try {
    if (type.measure != nullptr) type.measure(message, {}, frame);
    if (type.note != nullptr) type.note(message, contents);
    if (type.unpack != nullptr) type.unpack(message, packets);
    if (type.observe != nullptr) type.observe(message, 0, header);
  } catch (const std::runtime_error&) {  // left out and counted, see BagImport
  }
}

}  // namespace

const std::string& scratch() {
  struct Folder {
    std::string path = parent() + "/perception_fuzz_XXXXXX";
    /// In memory, where the system has files there: a disk takes ten times as long.
    static std::string parent() {
      const std::string memory = "/dev/shm";
      return ::access(memory.c_str(), W_OK) == 0 ? memory
                                                 : std::filesystem::temp_directory_path().string();
    }
    Folder() {
      if (::mkdtemp(path.data()) == nullptr) std::abort();
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

std::string written(const std::string& name, std::string_view bytes) {
  static std::map<std::string, std::string> there;  // most inputs change one of several files
  const std::string path = scratch() + "/" + name;
  if (const auto found = there.find(name); found != there.end() && found->second == bytes)
    return path;
  there[name] = bytes;
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

void readBag(const std::string& path) {
  const auto bag = openBag(path);
  for (BagMessage message; bag->next(message);) {
  }
}

void readDatabase(std::string_view bytes) {
  static const std::string seed = database();
  std::string changed = seed;
  for (; bytes.size() >= 3; bytes.remove_prefix(3)) {
    const auto at = static_cast<unsigned char>(bytes[0]) | static_cast<unsigned char>(bytes[1])
                                                               << 8;
    changed[static_cast<std::size_t>(at) % changed.size()] = bytes[2];
  }
  readBag(written("changed.db3", changed));
}

void readMessage(std::string_view bytes) {
  if (bytes.size() < 2) return;
  const auto& types = bagTypes();
  const BagType& type = types[static_cast<unsigned char>(bytes[0]) % types.size()];
  BagTopic topic;
  topic.name = "/metadata";
  topic.type = type.name;
  topic.encoding = bytes[1] % 2 == 0 ? ros::Encoding::kRos1 : ros::Encoding::kCdr;
  takeMessage(type, topic, bytes.substr(2));
}

void readMessageByFields(std::string_view bytes) {
  constexpr const char* kTypes[] = {"our_msgs/Any",
                                    "our_msgs/Any",
                                    "ars_40X/Any",
                                    "vision_msgs/Detection2DArray",
                                    "delphi_esr_msgs/EsrTrack",
                                    "autoware_perception_msgs/DetectedObjects",
                                    "derived_object_msgs/ObjectArray",
                                    "novatel_gps_msgs/Inspva",
                                    "geometry_msgs/TwistStamped",
                                    "sensor_msgs/PointCloud",
                                    "ros2_socketcan_msgs/FdFrame",
                                    "oxts_msgs/Ncom"};
  constexpr std::string_view kEnd = "--\n";
  const std::size_t end = bytes.find(kEnd);
  if (end == std::string_view::npos || end < 2) return;
  BagTopic topic;
  topic.name = "/any";
  topic.type = kTypes[static_cast<unsigned char>(bytes[0]) % std::size(kTypes)];
  topic.encoding = bytes[1] % 2 == 0 ? ros::Encoding::kRos1 : ros::Encoding::kCdr;
  topic.definition = bytes.substr(2, end - 2);
  const BagType* const type = bagType(topic);
  if (type != nullptr) takeMessage(*type, topic, bytes.substr(end + kEnd.size()));
}

}  // namespace perception
