#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libperception/batch/BatchResults.h"
#include "libperception/batch/BatchRun.h"

namespace perception {

/// The working folder while it lives: relative paths of a batch start where it was planned.
class WorkingIn {
 public:
  /// Throws DataError (kNoInput).
  explicit WorkingIn(const std::string& folder);
  ~WorkingIn();
  WorkingIn(const WorkingIn&) = delete;
  WorkingIn& operator=(const WorkingIn&) = delete;

 private:
  std::filesystem::path before_;
};

/// Path of a program in the folder of this one.
std::string programBeside(const std::string& name);
/// The shard, by its place in the manifest, that this process is a scheduler's task for.
std::optional<std::size_t> shardOfTask();
/// Processes and threads for so many shards on this machine, or as a scheduler grants them. `jobs`
/// 0: as many as cores.
BatchRunOptions optionsHere(int jobs, std::size_t shards);

/// Id, log, configuration and what else tells the shard from others, for people.
std::string labelOf(const Shard& shard);
/// The places of all shards in the manifest.
std::vector<std::size_t> allOf(const Batch& batch);
/// Throws Error for a shard without a result.
void requireResult(const Shard& shard, const ShardStatus& status);
/// How many shards have no result, or one with warnings, a sentence each.
std::vector<std::string> faultsOf(const Completeness& completeness);

/// Evaluates all and writes table, timing, database and page into the batch's folder. Throws
/// DataError, OutputError.
BatchResults writeBatchResults(const Batch& batch, const std::string& dir);

}  // namespace perception
