#include "libperception/batch/BatchResults.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/tables/Report.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/NumberFormat.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFigurePlaces = 6;

/// All numbers below `json` but those in lists (instants, single objects, bins).
void addFigures(const Json& json, const std::string& path, ShardResult& result) {
  for (const auto& [key, value] : json.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    if (value.is_number()) result.figures.emplace_back(name, value.get<double>());
    if (value.is_object()) addFigures(value, name, result);
  }
}

void evaluateShard(const EvaluationOptions& options, const std::string& dir, ShardResult& result) {
  const std::string truth = truthFileOf(result.shard.input);
  if (!result.status.hasResult() || !fs::exists(truth)) return;
  EvaluationReport report;
  report.options = options;
  try {
    const TrackedRun run = readTrackedRun(dir + "/" + result.shard.id);
    report.runs.push_back(
        {result.shard.id, run.dir, evaluate(run, readGroundTruth(truth), options)});
  } catch (const DataError& error) {
    result.evaluation_fault = error.what();
    return;
  }
  if (report.runs.front().evaluation.instants.empty()) {
    result.evaluation_fault = truth + ": no scene has a truth there";
    return;
  }
  addFigures(Json::parse(jsonReport(report)).at("runs").at(0), "", result);
}

/// Every shard must be of the batch's own version and inputs: figures of others beside them would
/// not compare.
void refuseStale(const BatchResults& results) {
  for (const ShardResult& result : results.shards) {
    if (result.status.state == ShardState::kStale) throw DataError(result.status.reason);
  }
}

std::string cell(double value) {
  const auto whole = static_cast<long long>(value);
  return static_cast<double>(whole) == value ? fmt::format("{}", whole)
                                             : fixedPlaces(value, kFigurePlaces);
}

template <class Value>
std::string ofRecord(const ShardResult& r, Value value) {
  return r.status.record ? fmt::format("{}", value(*r.status.record)) : "";
}

}  // namespace

const double* ShardResult::figure(const std::string& name) const {
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const auto& f) { return f.first == name; });
  return found == figures.end() ? nullptr : &found->second;
}

BatchResults batchResults(const Batch& batch, const std::string& dir) {
  BatchResults results;
  for (const Shard& shard : batch.shards)
    results.shards.push_back({shard, statusOf(shard, dir), {}, ""});
  std::sort(results.shards.begin(), results.shards.end(),
            [](const auto& a, const auto& b) { return a.shard.id < b.shard.id; });
  refuseStale(results);
  tbb::parallel_for(std::size_t{0}, results.shards.size(), [&](std::size_t i) {
    stopIfAsked();
    evaluateShard(batch.evaluation, dir, results.shards[i]);
  });
  std::set<std::string> known;
  for (const ShardResult& result : results.shards) {
    for (const auto& [name, value] : result.figures) {
      if (known.insert(name).second) results.figures.push_back(name);
    }
  }
  return results;
}

const std::vector<ShardColumn>& shardColumns() {
  using R = const ShardResult&;
  using Done = const RunRecord&;
  static const std::vector<ShardColumn> all = {
      {"id", "TEXT", [](R r) { return r.shard.id; }},
      {"log", "TEXT", [](R r) { return r.shard.input; }},
      {"config", "TEXT", [](R r) { return r.shard.config; }},
      {"sensors", "TEXT",
       [](R r) { return r.status.record ? r.status.record->sensors_used : r.shard.sensors; }},
      {"particles", "INTEGER",
       [](R r) {
         const int own = r.shard.particles;
         if (r.status.record) return fmt::format("{}", r.status.record->particles);
         return own > 0 ? fmt::format("{}", own) : "";
       }},
      {"seed", "TEXT",  // may exceed the integers of SQLite
       [](R r) {
         if (r.status.record) return fmt::format("{}", r.status.record->seed);
         return r.shard.seed ? fmt::format("{}", *r.shard.seed) : "";
       }},
      {"simulated", "INTEGER",
       [](R r) { return ofRecord(r, [](Done d) { return d.simulated ? 1 : 0; }); }},
      {"state", "TEXT", [](R r) { return std::string(nameOf(r.status.state)); }},
      {"code", "INTEGER",
       [](R r) {
         const bool failed = r.status.state == ShardState::kFailed;
         return failed ? fmt::format("{}", static_cast<int>(r.status.code)) : "";
       }},
      {"reason", "TEXT", [](R r) { return r.status.reason + r.evaluation_fault; }},
      {"log_seconds", "REAL",
       [](R r) {
         return ofRecord(r, [](Done d) { return fixedPlaces(d.last_stamp - d.first_stamp, 3); });
       }},
      {"scenes", "INTEGER", [](R r) { return ofRecord(r, [](Done d) { return d.scenes; }); }},
      {"tracks", "INTEGER", [](R r) { return ofRecord(r, [](Done d) { return d.tracks; }); }},
      {"warnings", "INTEGER",
       [](R r) { return ofRecord(r, [](Done d) { return d.warnings.size(); }); }},
  };
  return all;
}

std::string shardsCsv(const BatchResults& results) {
  StudyTable table;
  for (const ShardColumn& column : shardColumns()) table.columns.emplace_back(column.name);
  table.columns.insert(table.columns.end(), results.figures.begin(), results.figures.end());
  for (const ShardResult& result : results.shards) {
    auto& row = table.rows.emplace_back();
    for (const ShardColumn& column : shardColumns()) row.push_back(column.text(result));
    for (const std::string& name : results.figures) {
      const double* value = result.figure(name);
      row.push_back(value ? cell(*value) : "");
    }
  }
  return csvOf(table);
}

std::string timingCsv(const BatchResults& results, const std::string& dir) {
  StudyTable table;
  table.columns = {"id", "wall_seconds", "cpu_seconds", "real_time_factor", "peak_memory_bytes"};
  for (const ShardResult& r : results.shards) {
    std::ifstream file(dir + "/" + r.shard.id + "/timing.json");
    const auto json = Json::parse(file, nullptr, false);
    if (!r.status.hasResult() || !json.is_object()) continue;
    table.rows.push_back({r.shard.id});
    for (std::size_t c = 1; c < table.columns.size(); ++c) {
      const auto value = json.find(table.columns[c]);
      const bool known = value != json.end() && value->is_number();
      table.rows.back().push_back(known ? cell(value->get<double>()) : "");
    }
  }
  return csvOf(table);
}

}  // namespace perception
