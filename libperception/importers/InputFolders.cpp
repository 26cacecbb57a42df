#include "libperception/importers/InputFolders.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <sstream>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/clouds/CloudFolder.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/street_sets/NuscenesTables.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

using FolderKind = std::optional<InputKind>;

std::size_t countOf(const fs::path& folder, const std::vector<std::string>& endings) {
  const auto names = namesInFolder(folder);
  return static_cast<std::size_t>(std::count_if(names.begin(), names.end(), [&](const auto& name) {
    return std::any_of(endings.begin(), endings.end(),
                       [&](const std::string& end) { return hasEnding(name, end); });
  }));
}

const std::vector<std::string> kScanFiles = {".bin", ".bin.gz"};
const std::vector<std::string> kPictureFiles = {".png", ".jpg", ".jpeg"};

bool has(const fs::path& folder, std::initializer_list<const char*> parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [&](const char* part) { return fs::exists(folder / part); });
}

/// "velodyne: 108 files" of each folder that is there.
std::vector<std::string> filesOf(const fs::path& folder, std::initializer_list<const char*> parts) {
  std::vector<std::string> lines;
  for (const char* part : parts) {
    if (!fs::is_directory(folder / part)) continue;
    lines.push_back(fmt::format("{}: {} files", part, namesInFolder(folder / part).size()));
  }
  return lines;
}

FolderKind bagFolder(const fs::path& folder) {
  const auto names = namesInFolder(folder);
  const bool bags = std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "metadata.yaml" || hasEnding(name, ".db3") || hasEnding(name, ".mcap") ||
           hasEnding(name, ".bag") || hasEnding(name, ".db3.zstd") || hasEnding(name, ".mcap.zstd");
  });
  if (!bags) return {};
  return recordingOfRos(folder);
}

FolderKind nuscenesFolder(const fs::path& folder) {
  InputKind kind{"nuScenes: tables with samples/ and sweeps/", {}, {}};
  for (const std::string& name : namesInFolder(folder)) {
    if (name.back() != '/' || !fs::exists(folder / name / "scene.json")) continue;
    const std::string version = name.substr(0, name.size() - 1);
    const auto scenes = readNuscenesScenes((folder / version).string());
    kind.holds.push_back(fmt::format("{}: {} scenes", version, scenes.size()));
    constexpr std::size_t kMost = 10;
    for (std::size_t i = 0; i < std::min(scenes.size(), kMost); ++i)
      kind.holds.push_back(fmt::format("  {}  {} key frames  {}", scenes[i].name, scenes[i].samples,
                                       scenes[i].description));
    if (!scenes.empty())
      kind.commands.push_back(
          fmt::format("perception-import nuscenes --dir {} --version {} --scene {} -o {}.rawlog",
                      shellWord(folder), version, scenes[0].name, scenes[0].name));
  }
  return kind.commands.empty() ? FolderKind() : FolderKind(kind);
}

/// A drive of KITTI's raw data.
FolderKind kittiRawFolder(const fs::path& folder) {
  if (!has(folder, {"velodyne_points/data", "oxts/data"})) return {};
  InputKind kind{"a drive of KITTI's raw data",
                 filesOf(folder, {"velodyne_points/data", "oxts/data", "image_02/data"}),
                 {importCommand("kitti-raw --dir " + shellWord(folder), folder)}};
  if (has(folder, {"tracklet_labels.xml"}))
    kind.holds.emplace_back("tracklet_labels.xml: becomes the truth");
  return kind;
}

FolderKind semanticKittiFolder(const fs::path& folder) {
  const fs::path sequences = has(folder, {"dataset/sequences"}) ? folder / "dataset/sequences"
                             : has(folder, {"sequences"})       ? folder / "sequences"
                                                                : folder;
  const auto oneOf = [](const fs::path& sequence) -> FolderKind {
    if (!has(sequence, {"velodyne", "labels", "calib.txt", "poses.txt"})) return {};
    return InputKind{"a sequence of SemanticKITTI",
                     filesOf(sequence, {"velodyne", "labels"}),
                     {importCommand("semantickitti --dir " + shellWord(sequence), sequence)}};
  };
  if (sequences == folder) return oneOf(folder);
  for (const std::string& name : namesInFolder(sequences)) {
    if (auto kind = oneOf(sequences / name.substr(0, name.find('/')))) {
      kind->what = fmt::format("{} sequences of SemanticKITTI, the first with labels is {}",
                               namesInFolder(sequences).size(), name);
      return kind;
    }
  }
  return {};
}

/// The benchmark's folders; a sequence of it, if one is there.
FolderKind kittiTrackingFolder(const fs::path& given) {
  const fs::path folder = has(given, {"training/calib"}) ? given / "training" : given;
  std::vector<std::string> sequences;
  for (const std::string& name : namesInFolder(folder / "calib")) {
    const std::string number = name.substr(0, name.find('.'));
    if (fs::is_directory(folder / "velodyne" / number) ||
        fs::exists(folder / "label_02" / (number + ".txt")))
      sequences.push_back(number);
  }
  if (sequences.empty()) return {};
  const std::string& sequence = sequences.front();
  std::string words = "kitti --calib " + shellWord(folder / "calib" / (sequence + ".txt"));
  const auto add = [&](const char* option, const fs::path& path) {
    if (fs::exists(path)) words += fmt::format(" {} {}", option, shellWord(path));
  };
  add("--lidar", folder / "velodyne" / sequence);
  add("--images", folder / "image_02" / sequence);
  add("--labels", folder / "label_02" / (sequence + ".txt"));
  add("--oxts", folder / "oxts" / (sequence + ".txt"));
  if (!fs::exists(folder / "oxts" / (sequence + ".txt")))
    add("--poses", folder / "velo_poses" / (sequence + ".txt"));
  return InputKind{"the KITTI tracking benchmark",
                   {fmt::format("{} sequences; {}: {} scans", sequences.size(), sequence,
                                countOf(folder / "velodyne" / sequence, kScanFiles))},
                   {importCommand(words, sequence)}};
}

/// Data sets that are told by the folders that they have.
struct FolderRow {
  const char* what;
  std::vector<std::vector<const char*>> needs;  ///< of each list one is there
  const char* format;                           ///< of perception-import, with --dir
};

const std::vector<FolderRow>& folderRows() {
  static const std::vector<FolderRow> rows = {
      {"RADIATE: a turning radar, lidar, camera, GPS",
       {{"Navtech_Cartesian", "Navtech_Polar"}, {"velo_lidar", "zed_left"}},
       "radiate"},
      {"View of Delft: radar points, lidar, camera",
       {{"radar_points", "radar/training", "calib_radar"}, {"lidar_points", "lidar/training"}},
       "vod"},
      {"Boreas: lidar, turning radar, camera and poses",
       {{"lidar"}, {"applanix"}, {"calib"}},
       "boreas"},
      {"CADC: lidar, GPS/IMU and boxes in snow", {{"lidar_points/data"}, {"novatel/data"}}, "cadc"},
      {"SemanticSpray: scans in spray with a class per point",
       {{"velodyne"}, {"labels"}, {"ibeo_front", "ibeo_rear", "delphi_radar"}},
       "semanticspray"},
      {"Argoverse 2 as tables", {{"scans.csv"}, {"boxes.csv"}, {"calib.csv"}}, "av2"},
      {"aiMotive: lidar, two radars, camera",
       {{"scans.csv"}, {"calib.json"}, {"lidar"}},
       "aimotive"},
      {"comma2k19: tracks of a car's radar",
       {{"radar_tracks.csv"}, {"pose_20hz_ecef.csv"}},
       "comma2k19"},
      {"single frames of the KITTI object benchmark",
       {{"calib"}, {"velodyne"}, {"image_2", "label_2"}},
       "kitti-object"},
      {"single images of the KITTI object benchmark", {{"calib"}, {"image_2"}}, "images"},
      {"WADS: scans in snow with a class per point (SnowyKITTI has the same: snowykitti for wads)",
       {{"velodyne"}, {"labels"}},
       "wads"},
  };
  return rows;
}

FolderKind knownFolder(const fs::path& folder) {
  for (const FolderRow& row : folderRows()) {
    const bool all = std::all_of(row.needs.begin(), row.needs.end(), [&](const auto& any) {
      return std::any_of(any.begin(), any.end(),
                         [&](const char* part) { return fs::exists(folder / part); });
    });
    if (!all) continue;
    InputKind kind{
        row.what,
        {},
        {importCommand(fmt::format("{} --dir {}", row.format, shellWord(folder)), folder)}};
    for (const std::string& name : namesInFolder(folder)) {
      if (name.back() == '/')
        kind.holds.push_back(fmt::format("{} {} files", name, namesInFolder(folder / name).size()));
    }
    return kind;
  }
  return {};
}

/// A file of poses in the folder above the clouds; empty: there is none.
std::string posesBeside(const fs::path& folder) {
  const fs::path file = fs::absolute(folder / "..").lexically_normal() / "poses.txt";
  return fs::exists(file) ? file.string() : "";
}

}  // namespace

std::string shellWord(const fs::path& path) {
  const std::string text = path.string();
  const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("/._-+:=@%,").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string importCommand(const std::string& words, const fs::path& path) {
  std::string name = fs::absolute(path).lexically_normal().string();
  while (name.size() > 1 && name.back() == '/') name.pop_back();
  fs::path stem = fs::path(name).filename();
  while (!fs::is_directory(path) && stem.has_extension()) stem = stem.stem();
  return fmt::format("perception-import {} -o {}", words, shellWord(stem.string() + ".rawlog"));
}

bool hasEnding(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::vector<std::string> namesInFolder(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    names.push_back(entry.path().filename().string() + (entry.is_directory(error) ? "/" : ""));
  std::sort(names.begin(), names.end());
  return names;
}

InputKind recordingOfRos(const fs::path& path) {
  const BagContents contents = readContents(path.string());
  InputKind kind{"a recording of ROS: topics with messages, types and rates", {}, {}};
  std::istringstream lines(listOf(contents));
  for (std::string line; std::getline(lines, line);) kind.holds.push_back(line);
  kind.holds.insert(kind.holds.end(), contents.remarks.begin(), contents.remarks.end());
  for (const std::string& fault : contents.faults) kind.holds.push_back("FAULT " + fault);
  kind.commands.push_back(importCommand("bag --bag " + shellWord(path), path));
  return kind;
}

std::optional<InputKind> cloudFolder(const fs::path& folder) {
  // Text may be anything: a folder is of clouds by its other files.
  const auto names = namesInFolder(folder);
  const auto& endings = cloudEndings();
  const bool any = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return std::any_of(endings.begin(), endings.end(), [&](const std::string& end) {
      return end.compare(0, 4, ".txt") != 0 && hasEnding(name, end);
    });
  });
  if (!any) return {};
  std::vector<std::string> paths;
  for (const FrameFile& file : cloudFilesIn(folder.string()).scans) paths.push_back(file.path);
  InputKind kind{"a folder of point clouds", {}, {}};
  kind.holds.push_back(fmt::format("{} files, the first: {}", paths.size(),
                                   fs::path(paths.front()).filename().string()));
  CloudFormat format;
  format.columns.clear();
  format = foundFormat(paths, format);
  const LidarCloud cloud = readCloudFile(paths.front(), format);
  kind.holds.push_back(
      fmt::format("{} returns{}{}{}", cloud.size(), cloud.intensity.empty() ? "" : ", intensities",
                  cloud.ring.empty() ? "" : ", rings", cloud.time_offset.empty() ? "" : ", times"));
  if (!format.columns.empty())
    kind.holds.push_back(fmt::format("columns found from the data: {}{}",
                                     fmt::join(format.columns, " "),
                                     format.doubles ? ", of float64" : ""));
  const std::string poses = posesBeside(folder);
  kind.commands.push_back(
      importCommand(fmt::format("clouds --clouds {}{}", shellWord(folder),
                                poses.empty() ? "" : " --poses " + shellWord(poses)),
                    folder));
  return kind;
}

std::optional<InputKind> folderKind(const std::filesystem::path& folder) {
  for (const auto look : {&bagFolder, &nuscenesFolder, &kittiRawFolder, &semanticKittiFolder,
                          &kittiTrackingFolder, &knownFolder})
    if (auto kind = look(folder)) return kind;
  try {
    return cloudFolder(folder);
  } catch (const DataError&) {
    return {};  // tables of something else
  }
}

}  // namespace perception
