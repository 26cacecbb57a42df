#pragma once
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "libperception/batch/Completeness.h"
#include "libperception/batch/Manifest.h"
#include "libperception/core/system/ChildProcess.h"

namespace perception {

struct BatchRunOptions {
  std::string program;     ///< of perception-track
  int jobs = 1;            ///< processes at a time
  int threads = 1;         ///< of each
  bool overwrite = false;  ///< replace stale runs
  bool retry = false;      ///< run failed shards again, whatever they failed of
};

/// Runs shards of a batch on this machine, each as a process of perception-track with the limits of
/// the batch. A shard that has its result is left alone; one that fails, crashes, hangs or takes
/// too much memory is recorded as failed, and costs no other shard.
class BatchRun {
 public:
  /// What became of a shard, and the seconds it took.
  using Report = std::function<void(const Shard&, const ShardStatus&, double seconds)>;

  /// `dir`: the batch's folder, absolute; the working folder is Batch::folder.
  BatchRun(const Batch& batch, std::string dir, BatchRunOptions options);
  ~BatchRun();

  /// Those of the given shards (places in the manifest) that have neither a result nor a failure
  /// that would happen again, largest log first. Throws Error (kBadConfig) for stale ones without
  /// `overwrite`, and where a configuration has changed since the plan.
  std::vector<std::size_t> pending(const std::vector<std::size_t>& places) const;
  /// Runs them. Throws Error (kTryAgain) after SIGTERM or SIGINT, when its processes have ended.
  void run(const std::vector<std::size_t>& places, const Report& report);

 private:
  struct Job;
  void start(std::size_t place);
  void collect(const Report& report);
  ShardStatus statusAfter(const Job& job) const;

  const Batch& batch_;
  std::string dir_;
  BatchRunOptions options_;
  std::list<Job> jobs_;
};

}  // namespace perception
