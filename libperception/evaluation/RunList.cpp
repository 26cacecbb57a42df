#include "libperception/evaluation/RunList.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <set>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/system/PathPattern.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

// Folders that match a shell pattern, sorted by name.
std::vector<std::string> foldersOf(const std::string& pattern) {
  std::vector<std::string> folders = pathsMatching(pattern);
  const auto is_none = [](const std::string& path) { return !fs::is_directory(path); };
  folders.erase(std::remove_if(folders.begin(), folders.end(), is_none), folders.end());
  return folders;
}

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

std::vector<RunEntry> manifestEntries(const std::string& manifest) {
  const CsvTable table = CsvTable::fromFile(manifest);
  const fs::path folder = fs::path(manifest).parent_path();
  const auto condition = table.column("condition"), run = table.column("run"),
             truth = table.column("truth");
  std::vector<RunEntry> result;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, condition).empty()) table.fault(row, condition, "the name of a condition");
    result.push_back({std::string(table.text(row, condition)),
                      (folder / table.text(row, run)).string(),
                      (folder / table.text(row, truth)).string()});
  }
  if (result.empty()) throw DataError(manifest + ": no run in it");
  return result;
}

std::string truthOf(std::string path, const std::string& dir) {
  if (path.find("{log}") != std::string::npos) {
    replaceAll(path, "{log}", fs::path(readRunRecord(dir + "/done.json").input).stem().string());
  }
  replaceAll(path, "{run}", lastFolderOf(dir));
  return path;
}

}  // namespace

std::vector<std::string> namesOfRuns(const std::vector<RunEntry>& runs) {
  std::vector<std::string> names, paths;
  for (const RunEntry& run : runs) {
    names.push_back(lastFolderOf(run.dir));
    paths.push_back(run.dir);
  }
  return std::set<std::string>(names.begin(), names.end()).size() == runs.size() ? names : paths;
}

std::vector<RunEntry> runEntries(const std::vector<std::string>& runs,
                                 const std::string& truth_file, const std::string& manifest) {
  if (!manifest.empty()) {
    if (!runs.empty() || !truth_file.empty())
      throw Error(ExitCode::kUsage, "--manifest names runs and truths: no -r, no -t beside it");
    return manifestEntries(manifest);
  }
  if (runs.empty()) throw Error(ExitCode::kUsage, "-r/--run or --manifest is needed");
  if (truth_file.empty()) throw Error(ExitCode::kUsage, "-t/--truth is needed");
  std::vector<RunEntry> result;
  for (const std::string& run : runs) {
    const auto equals = run.find('=');
    // A path that contains '=' is not taken as a condition; C/H+R=... is.
    const auto slash = run.find('/');
    const bool in_folder = slash < equals && (slash == 0 || fs::exists(run.substr(0, slash)));
    const bool conditional =
        equals != std::string::npos && equals > 0 && !fs::exists(run) && !in_folder;
    if (!conditional) {
      result.push_back({"", run, truthOf(truth_file, run)});
      continue;
    }
    const std::string condition = run.substr(0, equals), pattern = run.substr(equals + 1);
    const std::vector<std::string> folders = foldersOf(pattern);
    if (folders.empty())
      throw DataError(fmt::format("{}: no folder of that name", pattern), ExitCode::kNoInput);
    for (const std::string& folder : folders)
      result.push_back({condition, folder, truthOf(truth_file, folder)});
  }
  return result;
}

void requireTruthOf(const RunRecord& record, const std::string& truth) {
  const std::string ending = ".truth.csv", name = fs::path(truth).filename().string();
  const std::string log = fs::path(record.input).filename().string();
  const auto dot = log.find(".rawlog");
  if (name.size() <= ending.size() || dot == std::string::npos ||
      name.compare(name.size() - ending.size(), ending.size(), ending) != 0 ||
      name.substr(0, name.size() - ending.size()) == log.substr(0, dot))
    return;
  throw DataError(
      fmt::format("{}: the run is of {}, whose truth is {}{}; with --any-truth this one "
                  "is taken all the same",
                  truth, log, log.substr(0, dot), ending));
}

}  // namespace perception
