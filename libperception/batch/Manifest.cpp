#include "libperception/batch/Manifest.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/output/FinishedRun.h"

namespace perception {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Shard& shard) {
  return {{"id", shard.id},
          {"input", shard.input},
          {"bytes", shard.bytes},
          {"sha256", shard.sha256},
          {"config", shard.config},
          {"config_sha", shard.config_sha},
          {"sensors", shard.sensors},
          {"particles", shard.particles},
          {"seed", shard.seed ? Json(*shard.seed) : Json(nullptr)}};
}

Shard shardOf(const Json& json) {
  Shard shard;
  json.at("id").get_to(shard.id);
  json.at("input").get_to(shard.input);
  json.at("bytes").get_to(shard.bytes);
  json.at("sha256").get_to(shard.sha256);
  json.at("config").get_to(shard.config);
  json.at("config_sha").get_to(shard.config_sha);
  json.at("sensors").get_to(shard.sensors);
  json.at("particles").get_to(shard.particles);
  if (!json.at("seed").is_null()) shard.seed = json.at("seed").get<std::uint64_t>();
  return shard;
}

std::ifstream opened(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw DataError(path + ": is not there: plan the batch first (perception-batch plan)",
                    ExitCode::kNoInput);
  }
  return file;
}

/// Calls `use` with the JSON of a text; faults name `place`.
template <class Use>
void parsed(const std::string& text, const std::string& place, Use use) {
  try {
    use(Json::parse(text));
  } catch (const Json::exception& error) {
    throw DataError(fmt::format("{}: found {}, expected what perception-batch plan writes", place,
                                error.what()));
  }
}

void readShards(const std::string& path, std::size_t expected, Batch& batch) {
  std::ifstream file = opened(path);
  std::set<std::string> ids;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string place = fmt::format("{}:{}", path, ++number);
    parsed(line, place, [&](const Json& json) { batch.shards.push_back(shardOf(json)); });
    if (!ids.insert(batch.shards.back().id).second)
      throw DataError(fmt::format("{}: shard {} is there twice", place, batch.shards.back().id));
  }
  if (number != expected) {
    throw DataError(fmt::format("{}: found {} shards, expected {} as in batch.json (was it cut?)",
                                path, number, expected));
  }
}

}  // namespace

std::string Shard::runHash() const { return hashOfRun(sha256, config_sha); }

void ShardLimits::visit(ParamVisitor& v) {
  v.real("memory", memory, {1, 4096}, "GB", "address space of the process of a shard");
  v.real("time", time, {1, 1e6}, "s", "processor time; a shard that takes more has failed");
}

std::string manifestText(const Batch& batch) {
  std::string text;
  for (const Shard& shard : batch.shards) text += json(shard).dump() + "\n";
  return text;
}

std::string batchText(const Batch& batch) {
  const SelectionOptions& truth = batch.evaluation.selection;
  const Json json = {
      {"program", "perception-batch"},
      {"version", batch.version},
      {"folder", batch.folder},
      {"config", batch.config},
      {"shards", batch.shards.size()},
      {"limits", {{"memory_gb", batch.limits.memory}, {"time_s", batch.limits.time}}},
      {"evaluation",
       {{"range_m", truth.range},
        {"fov_rad", truth.fov},
        {"complete_fov_rad", truth.complete_fov},
        {"min_points", truth.min_points}}}};
  return json.dump(1) + "\n";
}

Batch readBatch(const std::string& dir) {
  Batch batch;
  std::size_t shards = 0;
  const std::string path = dir + "/batch.json";
  std::ifstream file = opened(path);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  parsed(text, path, [&](const Json& json) {
    json.at("version").get_to(batch.version);
    json.at("folder").get_to(batch.folder);
    json.at("config").get_to(batch.config);
    json.at("shards").get_to(shards);
    json.at("limits").at("memory_gb").get_to(batch.limits.memory);
    json.at("limits").at("time_s").get_to(batch.limits.time);
    SelectionOptions& truth = batch.evaluation.selection;
    const Json& options = json.at("evaluation");
    options.at("range_m").get_to(truth.range);
    options.at("fov_rad").get_to(truth.fov);
    options.at("complete_fov_rad").get_to(truth.complete_fov);
    options.at("min_points").get_to(truth.min_points);
  });
  readShards(dir + "/manifest.jsonl", shards, batch);
  return batch;
}

std::string effectiveIniOf(const Shard& shard) {
  Config config = Config::fromFile(shard.config);
  if (shard.particles > 0)
    config.set(fmt::format("particle_filter.sampleSize={}", shard.particles));
  if (!shard.sensors.empty()) config.set("run.sensors=" + shard.sensors);
  if (shard.seed) config.set(fmt::format("run.seed={}", *shard.seed));
  PipelineSetup::read(config);
  config.finish();
  return config.effectiveText();
}

std::vector<std::string> trackArguments(const Shard& shard) {
  std::vector<std::string> words = {"-c", shard.config, "-i", shard.input};
  if (!shard.sensors.empty()) words.insert(words.end(), {"--sensors", shard.sensors});
  if (shard.seed) words.insert(words.end(), {"--seed", fmt::format("{}", *shard.seed)});
  if (shard.particles > 0) {
    words.insert(words.end(),
                 {"--set", fmt::format("particle_filter.sampleSize={}", shard.particles)});
  }
  return words;
}

}  // namespace perception
