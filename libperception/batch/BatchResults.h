#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libperception/batch/Completeness.h"
#include "libperception/batch/Manifest.h"

namespace perception {

/// A shard in the results of a batch.
struct ShardResult {
  Shard shard;
  ShardStatus status;
  /// Every number of its evaluation report by its path there, "closest.all.correct"; without those
  /// that are n/a. Empty where no truth stands beside the log.
  std::vector<std::pair<std::string, double>> figures;
  std::string evaluation_fault;  ///< why there are none, although there is a truth; else empty

  const double* figure(const std::string& name) const;  ///< null: n/a
};

/// Results of a batch: a function of manifest and finished shards, whatever the order and the
/// machines that they were run on.
struct BatchResults {
  std::vector<ShardResult> shards;   ///< by id
  std::vector<std::string> figures;  ///< names, in the order of the evaluation report
};

/// Reads the finished shards and evaluates them where FILE.truth.csv lies beside the log; relative
/// paths: from the working folder. Throws DataError for a shard of another run or version.
BatchResults batchResults(const Batch& batch, const std::string& dir);

/// A column of the tables of shards; empty text: not known.
struct ShardColumn {
  const char* name;
  const char* type;  ///< SQLite's: TEXT, INTEGER, REAL
  std::string (*text)(const ShardResult& result);
};
/// What a shard was made of and what became of it; the first one is its id.
const std::vector<ShardColumn>& shardColumns();

/// One line per shard: what it was made of, what became of it, its figures.
std::string shardsCsv(const BatchResults& results);
/// One line per finished shard: wall and processor time, real-time factor, peak memory. These
/// depend on the machines.
std::string timingCsv(const BatchResults& results, const std::string& dir);

}  // namespace perception
