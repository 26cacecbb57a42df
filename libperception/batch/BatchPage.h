#pragma once
#include <string>

#include "libperception/batch/BatchResults.h"

namespace perception {

/// A self-contained HTML page of a batch: what is done, failed and missing; a table of all shards,
/// sorted by any figure; histogram and extremes of a figure, its mean by condition; links to the
/// runs. `dir`: the batch's folder, in which the page will lie.
std::string batchPage(const Batch& batch, const BatchResults& results, const std::string& dir);

}  // namespace perception
