#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/batch/Manifest.h"
#include "libperception/core/Error.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {

enum class ShardState {
  kDone,      ///< without a warning
  kWarnings,  ///< done; part of the data was missing or bad
  kFailed,    ///< with an exit code and a reason
  kMissing,   ///< not run yet, or interrupted
  kStale      ///< its folder holds the run of another log, configuration or version
};
inline constexpr int kShardStates = 5;
const char* nameOf(ShardState state);

/// What became of a shard, as the files of the batch's folder say it.
struct ShardStatus {
  ShardState state = ShardState::kMissing;
  ExitCode code = ExitCode::kOk;    ///< of a failure
  std::string reason;               ///< of a failure; else empty
  std::optional<RunRecord> record;  ///< done.json, if it is this shard's

  bool hasResult() const { return record.has_value(); }
};

ShardStatus statusOf(const Shard& shard, const std::string& dir);

/// A failure that another try may mend: something was missing, full or busy. Others are a function
/// of the shard and would fail again.
bool isWorthRetry(ExitCode code);

/// failed/ID.json: why a shard failed. Holds for its hash only: after a change it is as if missing.
void writeFailure(const Shard& shard, const std::string& dir, ExitCode code,
                  const std::string& reason);
void removeFailure(const Shard& shard, const std::string& dir);

/// What became of all shards.
struct Completeness {
  std::vector<ShardStatus> shards;  ///< in the order of the manifest

  std::size_t count(ShardState state) const;
  bool complete() const;  ///< each shard has a result
  bool clean() const;     ///< and none has a warning
};
Completeness completenessOf(const Batch& batch, const std::string& dir);

/// A reason for the terminal; the whole one stands in failed/ID.json.
std::string shortened(const std::string& reason);
/// Counts by state, and the first failures one a line with log and reason.
std::string completenessTable(const Batch& batch, const Completeness& completeness);

}  // namespace perception
