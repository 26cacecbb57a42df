#pragma once
#include <string>

#include "libperception/batch/BatchResults.h"

namespace perception {

/// Writes the results as an SQLite database: tables `shards` (as shards.csv) and `figures` (shard,
/// name, value), view `conditions` (mean, least and largest of every figure by config, sensors and
/// particles). The same results give the same bytes. Throws OutputError.
void writeDatabase(const BatchResults& results, const std::string& path);

}  // namespace perception
