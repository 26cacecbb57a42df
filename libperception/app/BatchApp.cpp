#include "libperception/app/BatchApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "libperception/app/Programs.h"
#include "libperception/batch/BatchHere.h"
#include "libperception/batch/BatchPlan.h"
#include "libperception/batch/SlurmQueue.h"
#include "libperception/scene/files/RunTiming.h"

namespace perception {

namespace fs = std::filesystem;

void BatchApp::declare(CLI::App& cli) {
  struct Row {
    const char *name, *description;
    void (BatchApp::*declare)(CLI::App&);
    void (BatchApp::*task)();
  };
  static constexpr Row kRows[] = {
      {"plan", "list all runs in DIR/manifest.jsonl", &BatchApp::declarePlan, &BatchApp::plan},
      {"run", "run them here; what is done is left alone", &BatchApp::declareRun,
       &BatchApp::runShards},
      {"submit", "run them by Slurm, those that are missing", &BatchApp::declareSubmit,
       &BatchApp::submit},
      {"status", "what is done, failed, missing", &BatchApp::declareFolder, &BatchApp::status},
      {"reduce", "evaluate all: table, database, page", &BatchApp::declareFolder,
       &BatchApp::reduce}};
  cli.require_subcommand(1);
  for (const Row& row : kRows) {
    CLI::App& sub = *cli.add_subcommand(row.name, row.description);
    (this->*row.declare)(sub);
    sub.callback([this, task = row.task] { task_ = task; });
  }
}

void BatchApp::declareFolder(CLI::App& sub) {
  sub.add_option("-o,--output", output, "folder of the batch")->required()->type_name("DIR");
}

void BatchApp::declarePlan(CLI::App& sub) {
  declareFolder(sub);
  addConfigOptions(sub, true);
  sub.add_flag("--overwrite", overwrite, "replace another plan; finished runs are kept");
}

void BatchApp::declareRun(CLI::App& sub) {
  constexpr int kMostJobs = 4096;
  declareFolder(sub);
  sub.add_option("--jobs", jobs, "processes at a time; 0: as many as cores")
      ->check(CLI::Range(0, kMostJobs));
  sub.add_option("--index", index,
                 "this shard alone, by its line in the manifest from 0 on; default: "
                 "SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX, if set");
  sub.add_flag("--overwrite", overwrite, "replace runs of another configuration or version");
  sub.add_flag("--retry", retry, "also run shards again whose failure another try will not mend");
}

void BatchApp::declareSubmit(CLI::App& sub) {
  constexpr int kMostJobs = 100000;
  declareFolder(sub);
  sub.add_option("--jobs", jobs, "tasks of an array at a time; 0: all")
      ->check(CLI::Range(0, kMostJobs));
  sub.add_option("--sbatch", sbatch, "an option for sbatch: --sbatch=--partition=p (repeatable)")
      ->allow_extra_args(false);
  sub.add_flag("--retry", retry, "also what failed in a way that another try does not mend");
}

void BatchApp::run() { (this->*task_)(); }

std::string BatchApp::folder() const {
  const std::string path = fs::absolute(output).lexically_normal().string();
  return path.size() > 1 && path.back() == '/' ? path.substr(0, path.size() - 1) : path;
}

Batch BatchApp::batchOfThisVersion() const {
  Batch batch = readBatch(folder());
  if (batch.version != PERCEPTION_VERSION) {
    throw Error(ExitCode::kBadConfig,
                fmt::format("{}: planned by version {}, this is {}: plan again with --overwrite",
                            output, batch.version, PERCEPTION_VERSION));
  }
  return batch;
}

void BatchApp::plan() {
  Config config = loadConfig();
  if (print_config) {
    config.read<BatchParams>("batch");
    config.read<ShardLimits>("limits");
    config.read<BatchEvaluation>("evaluation");
    configDone(config);
    return;
  }
  const Batch batch = planBatch(config, PERCEPTION_VERSION);
  const bool written = writeBatch(batch, folder(), overwrite);
  fmt::print("{}: {} shards{}\n", output, batch.shards.size(), written ? "" : ", planned already");
}

std::optional<std::size_t> BatchApp::only(const Batch& batch) const {
  auto place = index;
  if (!place) place = shardOfTask();
  if (place && *place >= batch.shards.size()) {
    throw Error(ExitCode::kUsage,
                fmt::format("--index {}: the manifest has {} shards", *place, batch.shards.size()));
  }
  return place;
}

void BatchApp::runShards() {
  const std::string dir = folder();
  const Batch batch = batchOfThisVersion();
  const WorkingIn working(batch.folder);
  const std::optional<std::size_t> place = only(batch);
  const auto places = place ? std::vector<std::size_t>{*place} : allOf(batch);
  BatchRunOptions options = optionsHere(jobs, places.size());
  options.program = track_program.empty() ? programBeside("perception-track") : track_program;
  options.overwrite = overwrite;
  options.retry = retry;
  BatchRun runner(batch, dir, options);
  const std::vector<std::size_t> pending = runner.pending(places);
  std::size_t done = 0;
  double log_seconds = 0;
  const RunTiming timing;
  runner.run(pending, [&](const Shard& shard, const ShardStatus& status, double seconds) {
    if (status.record) log_seconds += status.record->last_stamp - status.record->first_stamp;
    fmt::print("[{}/{}] {}: {}{}{}, {:.1f} s\n", ++done, pending.size(), labelOf(shard),
               nameOf(status.state), status.reason.empty() ? "" : ": ", shortened(status.reason),
               seconds);
    std::fflush(stdout);
  });
  out_completeness = completenessOf(batch, dir);
  if (place) {
    const ShardStatus& status = out_completeness.shards[*place];
    requireResult(batch.shards[*place], status);
    if (status.state == ShardState::kWarnings)
      warn(fmt::format("{}: {}", batch.shards[*place].id, status.record->warnings.front()));
    return;
  }
  if (log_seconds > 0) {
    fmt::print("{:.0f} s of log in {:.0f} s: {:.1f} times real time, {} processes\n", log_seconds,
               timing.wallSeconds(), log_seconds / timing.wallSeconds(), options.jobs);
  }
  conclude(batch);
  if (const auto n = out_completeness.count(ShardState::kMissing); n > 0) {
    throw Error(ExitCode::kTryAgain,
                fmt::format("{} shards were interrupted, or another run writes them", n));
  }
  if (out_completeness.count(ShardState::kFailed) == batch.shards.size())
    throw DataError(output + ": no shard has a result");
}

void BatchApp::conclude(const Batch& batch) {
  fmt::print("{}", completenessTable(batch, out_completeness));
  for (const std::string& fault : faultsOf(out_completeness)) warn(fault);
}

void BatchApp::submit() {
  const std::string dir = folder();
  const Batch batch = batchOfThisVersion();
  const WorkingIn working(batch.folder);
  BatchRunOptions options;
  options.retry = retry;
  auto places = BatchRun(batch, dir, options).pending(allOf(batch));
  const SlurmQueue queue(batch, programBeside(name()), dir);
  const auto queued = queue.queued();
  const auto waits = [&](std::size_t place) { return queued.count(place) != 0; };
  places.erase(std::remove_if(places.begin(), places.end(), waits), places.end());
  if (places.empty()) {
    fmt::print("nothing to submit: {} shards in the queue, no other to run{}\n", queued.size(),
               queued.empty() ? fmt::format(" ({} reduce -o {})", name(), output) : "");
    return;
  }
  out_jobs = queue.submit(places, sbatch, jobs);
  fmt::print("{} shards submitted ({} were in the queue): jobs {}, the last one reduces\n",
             places.size(), queued.size(), fmt::join(out_jobs, ", "));
}

void BatchApp::status() {
  const Batch batch = readBatch(folder());
  out_completeness = completenessOf(batch, folder());
  conclude(batch);
}

void BatchApp::reduce() {
  const std::string dir = folder();
  const Batch batch = readBatch(dir);
  const WorkingIn working(batch.folder);
  const BatchResults results = writeBatchResults(batch, dir);
  out_completeness = completenessOf(batch, dir);
  conclude(batch);
  for (const ShardResult& result : results.shards) {
    if (!result.evaluation_fault.empty())
      warn(fmt::format("{}: no figures: {}", result.shard.id, result.evaluation_fault));
  }
  fmt::print("results in {}/index.html\n", output);
}

std::unique_ptr<App> batchApp() { return std::make_unique<BatchApp>(); }

}  // namespace perception
