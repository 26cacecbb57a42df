#include "libperception/importers/InputKind.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/InputFolders.h"
#include "libperception/importers/clouds/CloudFolder.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/Pcap.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

using Kind = std::optional<InputKind>;

Kind captureOf(const fs::path& file) {
  const PcapContents contents = readPcap(file.string());
  std::map<std::uint16_t, std::pair<std::size_t, std::size_t>> ports;  // packets, bytes
  for (const UdpPacket& packet : contents.packets) {
    ++ports[packet.port].first;
    ports[packet.port].second += packet.payload.size();
  }
  InputKind kind{"a capture of UDP packets", {}, {}};
  for (const auto& [port, count] : ports) {
    std::string devices;
    for (const DeviceKind& device : deviceKinds()) {
      if (device.port != port) continue;
      devices += fmt::format("{}{}", devices.empty() ? "" : " or ", device.name);
      kind.commands.push_back(
          importCommand(fmt::format("packets --pcap {} --device {}{}", shellWord(file), device.name,
                                    device.needs_file ? " --device-file FILE" : ""),
                        file));
    }
    kind.holds.push_back(fmt::format("port {}: {} packets, {} bytes each{}", port, count.first,
                                     count.second / count.first,
                                     devices.empty() ? "" : ", the usual port of " + devices));
  }
  kind.holds.insert(kind.holds.end(), contents.warnings.begin(), contents.warnings.end());
  if (kind.commands.empty())
    kind.commands.push_back(importCommand(
        fmt::format("packets --pcap {} --device DEVICE --port PORT", shellWord(file)), file));
  return kind;
}

std::string beginningOf(const fs::path& file) {
  constexpr std::size_t kBytes = 4096;
  std::string bytes(kBytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(kBytes));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

bool begins(const std::string& bytes, std::string_view with) {
  return bytes.compare(0, with.size(), with) == 0;
}

bool isCapture(const std::string& bytes) {
  using namespace std::string_view_literals;
  for (const auto magic : {"\xa1\xb2\xc3\xd4"sv, "\xd4\xc3\xb2\xa1"sv, "\xa1\xb2\x3c\x4d"sv,
                           "\x4d\x3c\xb2\xa1"sv, "\x0a\x0d\x0d\x0a"sv})
    if (begins(bytes, magic)) return true;
  return false;
}

bool isNameOfCloud(const std::string& name) {
  const auto& clouds = cloudEndings();
  return std::any_of(clouds.begin(), clouds.end(),
                     [&](const std::string& ending) { return hasEnding(name, ending); });
}

/// Lines of Udacity's measurements: L x y t, or R range bearing rate t.
bool isOfUdacity(const std::string& bytes) {
  const bool sensor =
      begins(bytes, "L\t") || begins(bytes, "R\t") || begins(bytes, "L ") || begins(bytes, "R ");
  return sensor && bytes.find_first_of("0123456789-.", 2) == 2;
}

/// By its first bytes, or the ending of its name; clouds are known by their folder.
Kind fileKind(const fs::path& file) {
  using namespace std::string_view_literals;
  const std::string bytes = beginningOf(file), name = file.filename().string();
  if (begins(bytes, "#ROSBAG V2") || begins(bytes, "\x89MCAP0"sv) ||
      begins(bytes, "SQLite format 3\0"sv) || hasEnding(name, ".db3.zstd") ||
      hasEnding(name, ".mcap.zstd"))
    return recordingOfRos(file);
  if (isCapture(bytes) || hasEnding(name, ".pcap.gz")) return captureOf(file);
  if (bytes.find("<gpx") != std::string::npos)
    return InputKind{"a GPX track", {}, {importCommand("gpx --track " + shellWord(file), file)}};
  if (begins(bytes, "$GP") || begins(bytes, "$GN"))
    return InputKind{
        "a GPS receiver's NMEA log", {}, {importCommand("nmea --track " + shellWord(file), file)}};
  const std::string line = bytes.substr(0, bytes.find('\n'));
  if (hasEnding(name, ".csv") && line.find("t_s") != std::string::npos &&
      line.find("lat_deg") != std::string::npos)
    return InputKind{
        "a table of GPS positions", {}, {importCommand("gpx --track " + shellWord(file), file)}};
  if (isOfUdacity(bytes))
    return InputKind{"Udacity's radar and laser measurements",
                     {},
                     {importCommand("udacity --measurements " + shellWord(file), file)}};
  return {};
}

Kind cloudKind(const fs::path& file) {
  if (!isNameOfCloud(file.filename().string())) return {};
  auto kind = cloudFolder(file.has_parent_path() ? file.parent_path() : fs::path("."));
  if (kind) kind->what = "a file of " + kind->what;
  return kind;
}

/// The first file of a folder that is known by itself.
Kind fileInFolder(const fs::path& folder) {
  for (const std::string& name : namesInFolder(folder)) {
    if (name.back() == '/') continue;
    auto kind = fileKind(folder / name);
    if (!kind) continue;
    kind->what += fmt::format(", in {}", (folder / name).string());
    return kind;
  }
  return {};
}

/// Why the folder is none of clouds, though it has files that could be.
std::string reasonOfTables(const std::string& folder) {
  try {
    cloudFolder(folder);
  } catch (const DataError& e) {
    return fmt::format("; as a folder of clouds: {}", e.what());
  }
  return "";
}

}  // namespace

std::optional<InputKind> inputKind(const std::string& path) {
  if (!fs::exists(path)) throw DataError(path + ": not found", ExitCode::kNoInput);
  // Of a file that is not known the reader of rawlogs says what it is.
  if (!fs::is_directory(path)) {
    auto kind = fileKind(path);
    if (!kind) kind = cloudKind(path);
    const std::string why = whyNotRead(fs::path(path).extension().string());
    if (!kind && !why.empty()) throw DataError(path + ": no recording that is known" + why);
    return kind;
  }
  if (auto kind = folderKind(path)) return kind;
  if (auto kind = fileInFolder(path)) return kind;
  for (const std::string& name : namesInFolder(path)) {
    if (name.back() != '/') continue;
    const fs::path folder = fs::path(path) / name.substr(0, name.size() - 1);
    if (auto kind = folderKind(folder)) {
      kind->what += fmt::format(", in {}", (fs::path(path) / name).string());
      return kind;
    }
    if (auto kind = fileInFolder(folder)) return kind;
  }
  throw DataError(fmt::format(
      "{}: nothing that is known in {} entries; known are rawlogs, recordings of ROS (.bag .mcap "
      ".db3), captures (.pcap), folders of clouds ({}), GPS tracks (.nmea .gpx) and the data sets "
      "of perception-import --help{}{}",
      path, namesInFolder(path).size(), fmt::join(cloudEndings(), " "), whatIsIn(path),
      reasonOfTables(path)));
}

std::string textOf(const InputKind& kind, const std::string& path) {
  std::string text = fmt::format("{}: {}\n", path, kind.what);
  for (const std::string& line : kind.holds) text += "  " + line + "\n";
  text += "to import it:\n";
  for (const std::string& line : kind.commands) text += "  " + line + "\n";
  return text + "then perception-doctor -i THE.rawlog -o DIR examines the log\n";
}

}  // namespace perception
