#include "libperception/batch/BatchPlan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libperception/config/IniFile.h"
#include "libperception/config/IniValue.h"
#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/core/system/PathPattern.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShortHash = 12;            // hexadecimal digits of a shard's id
constexpr unsigned long long kMostInRange = 1e5;  // numbers of a range: more is a slip

/// Numbers of a list whose words are numbers or ranges FIRST..LAST.
std::vector<unsigned long long> numbersOf(Config& config, const char* key,
                                          const std::vector<std::string>& words) {
  std::vector<unsigned long long> numbers;
  for (const std::string& word : words) {
    const auto dots = word.find("..");
    const auto first = parseUnsigned(word.substr(0, dots));
    const auto last = dots == std::string::npos ? first : parseUnsigned(word.substr(dots + 2));
    if (!first || !last || *last < *first || *last - *first >= kMostInRange) {
      config.fault("batch", key,
                   fmt::format("found '{}', expected a number or a range FIRST..LAST", word));
      continue;
    }
    for (auto number = *first; number <= *last; ++number) {
      numbers.push_back(number);
      if (number == *last) break;  // may be the largest there is
    }
  }
  return numbers;
}

/// Files of patterns that start at the INI's folder; patterns in their order, without repetitions.
std::vector<std::string> filesOf(const std::string& ini, const char* key,
                                 const std::vector<std::string>& patterns) {
  std::vector<std::string> files;
  for (const std::string& pattern : patterns) {
    const std::string whole = fs::path(joined(folderOf(ini), pattern)).lexically_normal().string();
    const auto found = pathsMatching(whole);
    if (found.empty()) {
      throw DataError(fmt::format("{}: [batch] {}: no file is {}", ini, key, whole),
                      ExitCode::kNoInput);
    }
    for (const std::string& path : found) {
      if (const auto what = irregularity(path); !what.empty())
        throw DataError(fmt::format("{}: found {}, expected a file", path, what));
      if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
    }
  }
  return files;
}

/// "" or {0} where a list is empty: the value of the configuration.
template <class Value>
std::vector<Value> orOwn(std::vector<Value> values, Value own) {
  if (values.empty()) values.push_back(std::move(own));
  return values;
}

std::string idOf(const Shard& shard) {
  const std::string seed = shard.seed ? fmt::format("{}", *shard.seed) : "";
  return sha256OfText(fmt::format("{}\n{}\n{}\n{}\n{}", shard.input, shard.config, shard.sensors,
                                  shard.particles, seed))
      .substr(0, kShortHash);
}

/// Shards of one log for each configuration with its settings; `shards` have no log yet.
void addLog(const std::string& log, const std::vector<Shard>& shards, Batch& batch) {
  const std::string sha256 = sha256OfFile(log);
  const std::uint64_t bytes = fs::file_size(log);
  for (Shard shard : shards) {
    shard.input = log;
    shard.bytes = bytes;
    shard.sha256 = sha256;
    shard.id = idOf(shard);
    batch.shards.push_back(std::move(shard));
  }
}

}  // namespace

void BatchParams::visit(ParamVisitor& v) {
  v.words("logs", logs, "rawlogs, or patterns of them");
  v.words("configs", configs, "site INIs, or patterns of them");
  v.words("sensors", sensors, "sensor sets (C+L, C+L+R); empty: that of the INI");
  v.words("particles", particles, "numbers of particles, or ranges 1..8; empty: that of the INI");
  v.words("seeds", seeds, "seeds, or ranges 1..8; empty: that of the INI");
  v.require(!logs.empty(), "logs is needed: rawlogs or patterns of them");
  v.require(!configs.empty(), "configs is needed: site INIs or patterns of them");
}

void BatchEvaluation::visit(ParamVisitor& v) {
  v.real("range", selection.range, {0.1, 1e4}, "m", "truth counts up to this distance");
  v.angle("fov_deg", selection.fov, {0.1, 360}, "whole angle ahead in which truth counts");
  v.angle("complete_fov_deg", selection.complete_fov, {0.1, 360},
          "whole angle ahead in which the truth knows every object (KITTI: 80)");
  v.integer("min_points", selection.min_points, {0, 1000000},
            "truth counts from this many lidar returns on");
}

Batch planBatch(Config& config, const std::string& version) {
  Batch batch;
  batch.version = version;
  batch.folder = fs::current_path().string();
  batch.config = fs::path(config.name()).filename().string();
  batch.limits = config.read<ShardLimits>("limits");
  batch.evaluation.selection = config.read<BatchEvaluation>("evaluation").selection;
  const auto params = config.read<BatchParams>("batch", {}, true);
  const auto particles = numbersOf(config, "particles", params.particles);
  const auto seeds = numbersOf(config, "seeds", params.seeds);
  for (const auto number : particles) {
    if (number < 1 || number > 1000000)
      config.fault("batch", "particles", fmt::format("{}: expected 1 .. 1000000", number));
  }
  config.finish();
  std::vector<std::optional<std::uint64_t>> all_seeds(seeds.begin(), seeds.end());
  std::vector<Shard> settings;
  for (const std::string& ini : filesOf(config.name(), "configs", params.configs)) {
    for (const std::string& sensors : orOwn(params.sensors, std::string())) {
      for (const auto number : orOwn(particles, 0ULL)) {
        for (const auto& seed : orOwn(all_seeds, std::optional<std::uint64_t>())) {
          stopIfAsked();
          Shard shard;
          shard.config = ini;
          shard.sensors = sensors;
          shard.particles = static_cast<int>(number);
          shard.seed = seed;
          shard.config_sha = configurationHash(effectiveIniOf(shard), version);
          settings.push_back(std::move(shard));
        }
      }
    }
  }
  for (const std::string& log : filesOf(config.name(), "logs", params.logs))
    addLog(log, settings, batch);
  return batch;
}

bool writeBatch(const Batch& batch, const std::string& dir, bool overwrite) {
  const std::string manifest = manifestText(batch), text = batchText(batch);
  if (fs::exists(dir + "/batch.json")) {
    std::string before_manifest, before_text;
    try {
      const Batch before = readBatch(dir);
      before_manifest = manifestText(before);
      before_text = batchText(before);
    } catch (const DataError&) {  // of another version, or damaged: another plan
    }
    if (before_manifest == manifest && before_text == text) return false;
    if (!overwrite) {
      throw Error(ExitCode::kBadConfig,
                  fmt::format("{}: holds another plan; give another folder, or --overwrite to "
                              "replace it (finished runs stay)",
                              dir));
    }
  }
  OutputFolder folder(dir);
  writeFile(folder.pathFor("manifest.jsonl"), manifest);
  writeFile(folder.pathFor("batch.json"), text);
  folder.commit("batch.json");
  return true;
}

}  // namespace perception
