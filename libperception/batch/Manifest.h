#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// One run of perception-track of a batch; a line of manifest.jsonl.
struct Shard {
  std::string id;  ///< short hash of input, config, sensors, particles and seed: name of its folder
  std::string input;                  ///< rawlog; relative paths: from Batch::folder
  std::uint64_t bytes = 0;            ///< of the rawlog
  std::string sha256;                 ///< of the rawlog
  std::string config;                 ///< INI
  std::string config_sha;             ///< configurationHash() with the settings below
  std::string sensors;                ///< --sensors; empty: those of the INI
  int particles = 0;                  ///< [particle_filter] sampleSize; 0: that of the INI
  std::optional<std::uint64_t> seed;  ///< empty: that of the INI

  /// What done.json of its run has as hash.
  std::string runHash() const;
};

/// [limits]: bounds of one shard. A shard that exceeds them has failed.
struct ShardLimits {
  double memory = 4;  ///< [GB] address space of the process (RLIMIT_AS); assumed
  double time = 900;  ///< [s] of processor time; assumed

  /// [s] that a shard may last: a machine may have other work, a disk may be away for a while.
  double longest() const { return 8 * time; }
  void visit(ParamVisitor& v);
};

/// A planned batch: batch.json and manifest.jsonl of its folder.
struct Batch {
  std::string version;           ///< of the programs: others give other bytes
  std::string folder;            ///< working folder of the plan, in which the shards run
  std::string config;            ///< file name of the INI of the plan
  ShardLimits limits;            ///< of each shard
  EvaluationOptions evaluation;  ///< of reduce: the truth that counts
  std::vector<Shard> shards;     ///< in the order of the plan
};

std::string manifestText(const Batch& batch);
std::string batchText(const Batch& batch);
/// Reads batch.json and manifest.jsonl. Throws DataError naming file, line and what is wrong:
/// kNoInput where nothing was planned, kBadInput for a manifest that is cut or has a shard twice.
Batch readBatch(const std::string& dir);

/// The INI of a shard with its settings, as perception-track reads it; relative paths: from the
/// working folder. Throws ConfigError.
std::string effectiveIniOf(const Shard& shard);
/// Arguments of perception-track for the shard, without program, output and threads.
std::vector<std::string> trackArguments(const Shard& shard);

}  // namespace perception
