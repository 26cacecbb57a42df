#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/batch/BatchRun.h"

namespace perception {

/// perception-batch: many logs, configurations, sensor sets, particles and seeds as one batch, on
/// this machine or in the queue of Slurm.
class BatchApp : public App {
 public:
  BatchApp()
      : App("perception-batch",
            "Tracks many logs with several configurations, sensor sets, particles and seeds, on "
            "this machine or by Slurm: a table, a database and a page of all figures.") {}

  int jobs = 0;                      ///< --jobs: processes at a time; 0: as many as cores
  std::optional<std::size_t> index;  ///< --index: one shard, by its place in the manifest
  bool overwrite = false;            ///< --overwrite: replace plan or stale runs
  bool retry = false;                ///< --retry: also what failed for good
  std::vector<std::string> sbatch;   ///< --sbatch: options of sbatch
  std::string track_program;         ///< path of perception-track; empty: beside this program

  Completeness out_completeness;      ///< of run, status, reduce
  std::vector<std::string> out_jobs;  ///< of submit: ids in the queue

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void plan();
  void runShards();
  void submit();
  void status();
  void reduce();
  void declarePlan(CLI::App& sub);
  void declareRun(CLI::App& sub);
  void declareSubmit(CLI::App& sub);
  void declareFolder(CLI::App& sub);

  std::string folder() const;
  Batch batchOfThisVersion() const;
  /// The shard of --index or of the scheduler; empty: all.
  std::optional<std::size_t> only(const Batch& batch) const;
  void conclude(const Batch& batch);

  void (BatchApp::*task_)() = nullptr;  ///< of the subcommand
};

}  // namespace perception
