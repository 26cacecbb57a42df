#pragma once
#include <string>
#include <vector>

#include "libperception/scene/files/RunRecord.h"

namespace perception {

/// One run to be evaluated; empty condition: not pooled.
struct RunEntry {
  std::string condition, dir, truth;
};

/// Expands -r, -t and --manifest, in that order. Throws Error (kUsage), DataError.
std::vector<RunEntry> runEntries(const std::vector<std::string>& runs,
                                 const std::string& truth_file, const std::string& manifest);

/// Last folders if they are unique, else the paths as given.
std::vector<std::string> namesOfRuns(const std::vector<RunEntry>& runs);

/// Throws DataError where a truth, LOG.truth.csv, is by its name of another log than the run's
/// LOG.rawlog: frame numbers and times are alike in many logs.
void requireTruthOf(const RunRecord& record, const std::string& truth);

}  // namespace perception
