#include "libperception/interop/bags/ReadingBag.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/interop/bags/Compression.h"
#include "libperception/interop/bags/InflatedFile.h"
#include "libperception/interop/bags/McapFormat.h"
#include "libperception/interop/bags/RecordBag.h"
#include "libperception/interop/bags/SqliteBag.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);
constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";
constexpr std::size_t kLongestMagic = 16;
constexpr const char* kMetadata = "metadata.yaml";

bool startsWith(std::string_view bytes, std::string_view magic) {
  return bytes.substr(0, magic.size()) == magic;
}

bool endsWith(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool isBagName(const std::string& path) {
  for (const char* end : {".mcap", ".bag", ".db3", ".mcap.zstd", ".db3.zstd"}) {
    if (endsWith(path, end)) return true;
  }
  return false;
}

/// drive_2 before drive_10: digits by their value.
bool beforeByNumbers(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& name) {
    std::string out, digits;
    for (const char c : name + '\0') {
      if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
        digits += c;
        continue;
      }
      constexpr std::size_t kWidth = 20;
      if (!digits.empty() && digits.size() < kWidth) out.append(kWidth - digits.size(), '0');
      out += digits + c;
      digits.clear();
    }
    return out;
  };
  return std::pair(key(a), a) < std::pair(key(b), b);
}

std::unique_ptr<ReadingBag> openBytes(const std::string& name, const std::string& path,
                                      bool inflated);

/// The file inside a zstd file; gone from the disk when it is closed.
std::unique_ptr<ReadingBag> openInflated(const std::string& path) {
  auto file = std::make_unique<InflatedFile>(path);
  auto bag = openBytes(path, file->path(), true);
  return insideBag(path, std::move(bag), std::move(file));
}

std::unique_ptr<ReadingBag> openBytes(const std::string& name, const std::string& path,
                                      bool inflated) {
  auto file = fileSource(path);
  const std::string begin(file->take(std::min<std::uint64_t>(file->size(), kLongestMagic), "it"));
  if (startsWith(begin, kSqliteMagic)) return sqliteBag(name, path);
  if (startsWith(begin, kZstdMagic) && !inflated) return openInflated(path);
  file = fileSource(path);
  if (startsWith(begin, mcap::kMagic)) {
    file->skip(mcap::kMagic.size(), "the magic");
    return mcapBag(name, std::move(file));
  }
  if (startsWith(begin, kRos1Magic)) {
    file->skip(kRos1Magic.size(), "the magic");
    return ros1Bag(name, std::move(file));
  }
  throw DataError(
      fmt::format("{}: byte 0: expected an MCAP file, a ROS 1 bag \"#ROSBAG V2.0\" or "
                  "an sqlite file of rosbag2 (.db3)",
                  name));
}

/// The number of messages by rosbag2's own count.
std::optional<std::uint64_t> countOfMetadata(const std::string& path) {
  std::ifstream file(path);
  // The file's own entry is less far to the right than that of each topic.
  constexpr std::string_view kKey = "  message_count: ";
  for (std::string line; std::getline(file, line);) {
    if (!startsWith(line, kKey)) continue;
    std::uint64_t count = 0;
    const char* const end = line.data() + line.size();
    if (std::from_chars(line.data() + kKey.size(), end, count).ec == std::errc()) return count;
  }
  return {};
}

}  // namespace

std::string BagMessage::place() const {
  return fmt::format("{} {}", in_row ? "row" : "byte", offset);
}

std::string ReadingBag::shortType(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

bool ReadingBag::next(BagMessage& message) {
  while (nextStored(message)) {
    // CDR begins with 00: a zstd frame is no message, but holds one.
    if (message.topic->encoding != ros::Encoding::kCdr || !startsWith(message.bytes, kZstdMagic))
      return true;
    try {
      inflated_ = inflatedZstd(message.bytes);
    } catch (const std::runtime_error& e) {
      if (unreadable_++ == 0)
        faults_.push_back(
            fmt::format("{}: {}: a compressed message of {}: {}: left out, and others like it",
                        path_, message.place(), message.topic->name, e.what()));
      continue;
    }
    message.bytes = inflated_;
    return true;
  }
  return false;
}

std::unique_ptr<ReadingBag> openBag(const std::string& path) {
  return openBytes(path, path, false);
}

std::vector<std::string> bagFiles(const std::string& path) {
  if (!fs::exists(path)) throw DataError(path + ": no such file or folder", ExitCode::kNoInput);
  if (!fs::is_directory(path)) return {path};
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string name = entry.path().string();
    // Players leave the inflated file beside its source.
    constexpr std::string_view kZstd = ".zstd";
    const bool again =
        endsWith(name, kZstd) && fs::exists(name.substr(0, name.size() - kZstd.size()));
    if (isBagName(name) && !again) files.push_back(name);
  }
  if (files.empty())
    throw DataError(path + ": no .mcap, .bag or .db3 file in this folder", ExitCode::kNoInput);
  std::sort(files.begin(), files.end(), &beforeByNumbers);
  return files;
}

std::string faultOfBagFolder(const std::string& path, std::uint64_t messages) {
  if (!fs::is_directory(path)) return "";
  const std::string metadata = (fs::path(path) / kMetadata).string();
  if (!fs::exists(metadata)) {
    const auto files = bagFiles(path);
    const bool sqlite = std::any_of(files.begin(), files.end(), [](const std::string& name) {
      return endsWith(name, ".db3") || endsWith(name, ".db3.zstd");
    });
    return sqlite ? fmt::format(
                        "{}: no {}, which is written when a recording is closed: its end "
                        "may be missing",
                        path, kMetadata)
                  : "";
  }
  const auto count = countOfMetadata(metadata);
  if (!count || *count <= messages) return "";
  return fmt::format("{}: {} messages by its {}, but {} can be read", path, *count, kMetadata,
                     messages);
}

}  // namespace perception
