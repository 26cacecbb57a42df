#pragma once
#include <string>

#include "libperception/batch/Manifest.h"
#include "libperception/config/Config.h"

namespace perception {

/// [batch]: every log with every configuration, sensor set, number of particles and seed.
struct BatchParams {
  std::vector<std::string> logs;       ///< rawlogs or patterns of them, from the INI's folder
  std::vector<std::string> configs;    ///< site INIs or patterns of them, from the INI's folder
  std::vector<std::string> sensors;    ///< as --sensors of perception-track
  std::vector<std::string> particles;  ///< numbers or ranges 1..8
  std::vector<std::string> seeds;      ///< the same

  void visit(ParamVisitor& v);
};

/// The truth that counts in the figures of a batch: [evaluation], as the options of
/// perception-evaluate.
struct BatchEvaluation {
  SelectionOptions selection;

  void visit(ParamVisitor& v);
};

/// Plans the batch of an INI: finds and hashes the logs, checks every configuration. Paths of the
/// plan are relative where those of the INI are, from the working folder. Throws ConfigError,
/// DataError.
Batch planBatch(Config& config, const std::string& version);

/// Writes batch.json and manifest.jsonl. False: the same plan is there already. Throws Error
/// (kBadConfig) if another one is there and not `overwrite`, which leaves finished runs as they
/// are; OutputError.
bool writeBatch(const Batch& batch, const std::string& dir, bool overwrite);

}  // namespace perception
