#include "libperception/pictures/pages/CompareRuns.h"

#include <fmt/format.h>

#include <filesystem>

#include "libperception/config/IniDocument.h"
#include "libperception/core/Error.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr char kIni[] = "effective.ini";

ComparedRun readRun(const std::string& dir, std::vector<std::string>& without_origin) {
  ComparedRun run;
  run.dir = dir;
  run.record = readRunRecord((fs::path(dir) / "done.json").string());
  const fs::path report = fs::path(dir) / "evaluation" / "report.json";
  if (!fs::exists(report)) return run;
  run.evaluation = figuresOf(report, idOfRun(run.record));
  if (run.evaluation.is_null()) without_origin.push_back(report.string());
  return run;
}

void requireSameLog(const ComparedRun& a, const ComparedRun& b) {
  const auto name = [](const ComparedRun& run) {
    return fs::path(run.record.input).filename().string();
  };
  const auto said = [&](const ComparedRun& run) {
    return fmt::format("{} of {} ({} to {} s)", run.dir, name(run),
                       decimalSeconds(run.record.first_stamp.ns),
                       decimalSeconds(run.record.last_stamp.ns));
  };
  const bool overlap =
      a.record.first_stamp <= b.record.last_stamp && b.record.first_stamp <= a.record.last_stamp;
  if (name(a) == name(b) && overlap) return;
  throw DataError(fmt::format("runs of different logs: {} and {}", said(a), said(b)));
}

std::vector<KeyDifference> keysThatDiffer(const std::string& ini_a, const std::string& ini_b) {
  IniDocument a, b;
  a.readFile(ini_a);
  b.readFile(ini_b);
  const auto find = [](const IniDocument& in, const std::string& section, const std::string& key) {
    const IniSection* found = in.find(section);
    return found ? found->find(key) : nullptr;
  };
  std::vector<KeyDifference> keys;
  for (const IniSection& section : a.sections()) {
    for (const IniEntry& entry : section.entries) {
      const IniEntry* other = find(b, section.name, entry.key);
      if (!other || other->value != entry.value)
        keys.push_back({section.name + "." + entry.key, entry.value, other ? other->value : ""});
    }
  }
  for (const IniSection& section : b.sections()) {
    for (const IniEntry& entry : section.entries) {
      if (!find(a, section.name, entry.key))
        keys.push_back({section.name + "." + entry.key, "", entry.value});
    }
  }
  return keys;
}

}  // namespace

RunComparison readComparison(const std::string& dir_a, const std::string& dir_b) {
  RunComparison comparison;
  comparison.a = readRun(dir_a, comparison.without_origin);
  comparison.b = readRun(dir_b, comparison.without_origin);
  requireSameLog(comparison.a, comparison.b);
  const std::string ini_a = (fs::path(dir_a) / kIni).string();
  const std::string ini_b = (fs::path(dir_b) / kIni).string();
  if (!fs::exists(ini_a)) comparison.without_ini.push_back(dir_a);
  if (!fs::exists(ini_b)) comparison.without_ini.push_back(dir_b);
  if (comparison.without_ini.empty()) comparison.keys = keysThatDiffer(ini_a, ini_b);
  comparison.a.tracked = readTrackedRun(dir_a);
  comparison.b.tracked = readTrackedRun(dir_b);
  const TrackedRun &a = comparison.a.tracked, &b = comparison.b.tracked;
  comparison.difference = compareRuns(a, b);
  if (comparison.difference.common == 0 && !a.scenes.empty() && !b.scenes.empty())
    throw DataError(fmt::format("{} and {}: no instant in common", dir_a, dir_b));
  return comparison;
}

}  // namespace perception
