#include "libperception/importers/clouds/CloudFolder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/ImportClouds.h"

namespace perception {
namespace {

/// Formats of clouds, and of tables with clouds, that are common and not read.
constexpr const char* kNotRead[] = {".las", ".laz", ".e57",      ".pts",     ".h5",     ".hdf5",
                                    ".mat", ".drc", ".tfrecord", ".feather", ".parquet"};

}  // namespace

std::string whatIsIn(const std::string& folder) {
  std::map<std::string, std::size_t> endings;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    ++endings[entry.is_directory(error) ? "/" : entry.path().extension().string()];
  std::string text;
  for (const auto& [ending, count] : endings)
    text += ending == "/" ? fmt::format("; {} folders", count)
                          : fmt::format("; {} files that end in '{}'", count, ending);
  for (const auto& row : endings) text += whyNotRead(row.first);
  return text;
}

std::string whyNotRead(const std::string& ending) {
  for (const char* archive : {".zip", ".tar", ".tgz", ".7z", ".rar"})
    if (ending == archive) return fmt::format("; {} is an archive: unpack it", ending);
  if (std::find(std::begin(kNotRead), std::end(kNotRead), ending) == std::end(kNotRead)) return "";
  return fmt::format("; {} is not read: save the scans as .pcd, .ply or text", ending);
}

CloudFiles cloudFilesIn(const std::string& folder) {
  const std::filesystem::path path = folder;
  if (std::filesystem::is_regular_file(path))
    throw DataError(folder + ": not a folder" + whyNotRead(path.extension().string()));
  requireFolder(folder);
  std::map<std::string, std::vector<std::string>> names;  // by ending without .gz
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string(), ending = cloudEndingOf(name);
    const auto& known = cloudEndings();
    if (std::find(known.begin(), known.end(), ending) != known.end()) names[ending].push_back(name);
  }
  if (names.empty())
    throw DataError(fmt::format("{}: no file that ends in {}{}", folder,
                                fmt::join(cloudEndings(), ", "), whatIsIn(folder)),
                    ExitCode::kNoInput);
  const auto numbered = [](const std::string& name) {
    return std::any_of(name.begin(), name.end(),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
  };
  // Text may be anything, and lies beside scans as often as they.
  const auto weightOf = [&](const std::string& ending) {
    const auto& of = names[ending];
    const auto numbers = static_cast<double>(std::count_if(of.begin(), of.end(), numbered));
    return (numbers + 1e-3 * static_cast<double>(of.size())) * (ending == ".txt" ? 0.5 : 1);
  };
  std::string most;
  for (const auto& row : names)
    if (most.empty() || weightOf(row.first) > weightOf(most)) most = row.first;
  const bool any_number = std::any_of(names[most].begin(), names[most].end(), numbered);
  CloudFiles files;
  std::set<std::string> scans;
  for (const auto& [ending, of] : names) {
    const bool candidates = ending == most || (ending != ".txt" && ending != ".csv");
    for (const std::string& name : of) {
      if (candidates && (!any_number || numbered(name)))
        scans.insert(name);
      else
        files.others.push_back(name);
    }
  }
  std::sort(files.others.begin(), files.others.end());
  files.scans = frameFiles(folder, cloudEndings(),
                           [&](const std::string& name) { return scans.count(name) != 0; });
  return files;
}

}  // namespace perception
