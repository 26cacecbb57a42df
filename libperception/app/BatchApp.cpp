#include "libperception/app/BatchApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <thread>

#include "libperception/app/Programs.h"
#include "libperception/batch/BatchDatabase.h"
#include "libperception/batch/BatchPage.h"
#include "libperception/batch/BatchPlan.h"
#include "libperception/batch/BatchResults.h"
#include "libperception/batch/SlurmQueue.h"
#include "libperception/config/IniValue.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunTiming.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// The working folder while it lives: relative paths of a batch start where it was planned.
class WorkingIn {
 public:
  explicit WorkingIn(const std::string& folder) : before_(fs::current_path()) {
    std::error_code error;
    fs::current_path(folder, error);
    if (error) {
      throw DataError(fmt::format("{}: the batch was planned there: {}", folder, error.message()),
                      ExitCode::kNoInput);
    }
  }
  ~WorkingIn() {
    std::error_code ignored;
    fs::current_path(before_, ignored);
  }
  WorkingIn(const WorkingIn&) = delete;
  WorkingIn& operator=(const WorkingIn&) = delete;

 private:
  fs::path before_;
};

std::string programBeside(const std::string& name) {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  return error ? name : (self.parent_path() / name).string();
}

/// A number that a scheduler gives its jobs.
std::optional<std::size_t> numberFrom(const char* variable) {
  const char* text = std::getenv(variable);
  const auto number = text ? parseUnsigned(text) : std::nullopt;
  return number ? std::optional<std::size_t>(*number) : std::nullopt;
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

int cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace

std::string BatchApp::description() const {
  return "Tracks many logs with several configurations, sensor sets, particles and seeds, on this "
         "machine or by Slurm: a table, a database and a page of all figures.";
}

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
  if (!place) place = numberFrom("SLURM_ARRAY_TASK_ID");
  if (!place) place = numberFrom("JOB_COMPLETION_INDEX");
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
  BatchRunOptions options;
  options.program = track_program.empty() ? programBeside("perception-track") : track_program;
  options.jobs = std::min(jobs > 0 ? jobs : cores(), static_cast<int>(places.size()));
  const auto granted = numberFrom("SLURM_CPUS_PER_TASK");
  options.threads = granted ? static_cast<int>(*granted) : std::max(1, cores() / options.jobs);
  if (!granted && numberFrom("SLURM_ARRAY_TASK_ID")) options.threads = 1;
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
  if (place) return concludeShard(batch, *place);
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

void BatchApp::concludeShard(const Batch& batch, std::size_t place) {
  const ShardStatus& status = out_completeness.shards[place];
  const Shard& shard = batch.shards[place];
  if (status.state == ShardState::kFailed)
    throw Error(status.code, fmt::format("{}: {}", shard.id, status.reason));
  if (!status.hasResult())
    throw Error(ExitCode::kTryAgain, shard.id + ": interrupted, or another run writes it");
  if (status.state == ShardState::kWarnings)
    warn(fmt::format("{}: {}", shard.id, status.record->warnings.front()));
}

void BatchApp::conclude(const Batch& batch) {
  const Completeness& c = out_completeness;
  fmt::print("{}", completenessTable(batch, c));
  const auto warnOf = [&](ShardState state, const char* what) {
    if (const auto n = c.count(state); n > 0)
      warn(fmt::format("{} of {} shards {}", n, c.shards.size(), what));
  };
  warnOf(ShardState::kFailed, "failed");
  warnOf(ShardState::kMissing, "are missing");
  warnOf(ShardState::kStale, "are of another run");
  warnOf(ShardState::kWarnings, "have data warnings: done.json of each says which");
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
  const BatchResults results = batchResults(batch, dir);
  OutputFolder out(dir);
  writeFile(out.pathFor("shards.csv"), shardsCsv(results));
  writeFile(out.pathFor("timing.csv"), timingCsv(results, dir));
  writeDatabase(results, out.pathFor("batch.sqlite"));
  writeFile(out.pathFor("index.html"), batchPage(batch, results, dir));
  out.commit("index.html");
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
