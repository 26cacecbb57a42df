#pragma once
#include <set>
#include <string>
#include <vector>

#include "libperception/batch/Manifest.h"

namespace perception {

/// A batch in the queue of Slurm: one array task per shard, then the reduce job, which runs even if
/// shards failed. What is done is recorded in the batch's folder and not in the queue: if the queue
/// is lost, submitting again fills it.
class SlurmQueue {
 public:
  /// `program`: perception-batch; `dir`: the batch's folder; both absolute and reachable from every
  /// node.
  SlurmQueue(const Batch& batch, std::string program, std::string dir);

  /// Shards (places in the manifest) that wait or run, without those that Slurm holds after it
  /// could not launch them. Throws Error (kUnavailable) with what Slurm says.
  std::set<std::size_t> queued() const;
  /// Submits these shards and the reduce job; `options` go to sbatch as they are. At most `jobs` of
  /// an array run at a time (0: all). Returns the job ids, that of reduce last. Throws as queued().
  std::vector<std::string> submit(const std::vector<std::size_t>& places,
                                  const std::vector<std::string>& options, int jobs) const;

 private:
  std::size_t mostTasks() const;
  std::string call(const std::vector<std::string>& words) const;

  const Batch& batch_;
  std::string program_, dir_, name_;
};

/// Numbers as sbatch --array takes them: "0-2,7".
std::string arrayRanges(const std::vector<std::size_t>& sorted);
/// A word of a shell command.
std::string shellQuoted(const std::string& word);

}  // namespace perception
