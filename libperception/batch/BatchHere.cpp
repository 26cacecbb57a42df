#include "libperception/batch/BatchHere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <system_error>
#include <thread>

#include "libperception/batch/BatchDatabase.h"
#include "libperception/batch/BatchPage.h"
#include "libperception/config/IniValue.h"
#include "libperception/core/Error.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

/// A number that a scheduler gives its jobs.
std::optional<std::size_t> numberFrom(const char* variable) {
  const char* text = std::getenv(variable);
  const auto number = text ? parseUnsigned(text) : std::nullopt;
  return number ? std::optional<std::size_t>(*number) : std::nullopt;
}

}  // namespace

WorkingIn::WorkingIn(const std::string& folder) : before_(std::filesystem::current_path()) {
  std::error_code error;
  std::filesystem::current_path(folder, error);
  if (error) {
    throw DataError(fmt::format("{}: the batch was planned there: {}", folder, error.message()),
                    ExitCode::kNoInput);
  }
}

WorkingIn::~WorkingIn() {
  std::error_code ignored;
  std::filesystem::current_path(before_, ignored);
}

std::string programBeside(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? name : (self.parent_path() / name).string();
}

std::optional<std::size_t> shardOfTask() {
  const auto place = numberFrom("SLURM_ARRAY_TASK_ID");
  return place ? place : numberFrom("JOB_COMPLETION_INDEX");
}

BatchRunOptions optionsHere(int jobs, std::size_t shards) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  BatchRunOptions options;
  options.jobs = std::min(jobs > 0 ? jobs : cores, static_cast<int>(shards));
  const auto granted = numberFrom("SLURM_CPUS_PER_TASK");
  options.threads = granted ? static_cast<int>(*granted) : std::max(1, cores / options.jobs);
  if (!granted && numberFrom("SLURM_ARRAY_TASK_ID")) options.threads = 1;
  return options;
}

std::string labelOf(const Shard& shard) {
  std::string text = fmt::format("{} {} {}", shard.id, shard.input, shard.config);
  if (!shard.sensors.empty()) text += " " + shard.sensors;
  if (shard.particles > 0) text += fmt::format(" {} particles", shard.particles);
  if (shard.seed) text += fmt::format(" seed {}", *shard.seed);
  return text;
}

std::vector<std::size_t> allOf(const Batch& batch) {
  std::vector<std::size_t> all(batch.shards.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

void requireResult(const Shard& shard, const ShardStatus& status) {
  if (status.state == ShardState::kFailed)
    throw Error(status.code, fmt::format("{}: {}", shard.id, status.reason));
  if (!status.hasResult())
    throw Error(ExitCode::kTryAgain, shard.id + ": interrupted, or another run writes it");
}

std::vector<std::string> faultsOf(const Completeness& completeness) {
  std::vector<std::string> faults;
  const auto add = [&](ShardState state, const char* what) {
    if (const auto n = completeness.count(state); n > 0)
      faults.push_back(fmt::format("{} of {} shards {}", n, completeness.shards.size(), what));
  };
  add(ShardState::kFailed, "failed");
  add(ShardState::kMissing, "are missing");
  add(ShardState::kStale, "are of another run");
  add(ShardState::kWarnings, "have data warnings: done.json of each says which");
  return faults;
}

BatchResults writeBatchResults(const Batch& batch, const std::string& dir) {
  BatchResults results = batchResults(batch, dir);
  OutputFolder out(dir);
  writeFile(out.pathFor("shards.csv"), shardsCsv(results));
  writeFile(out.pathFor("timing.csv"), timingCsv(results, dir));
  writeDatabase(results, out.pathFor("batch.sqlite"));
  writeFile(out.pathFor("index.html"), batchPage(batch, results, dir));
  out.commit("index.html");
  return results;
}

}  // namespace perception
