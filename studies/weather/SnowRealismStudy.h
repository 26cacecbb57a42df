#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/weather/SnowForest.h"

namespace perception {

/// Scans of a log whose returns are labelled (FILE_Labels beside it), restricted to the sector.
/// Throws DataError where no scan has labels.
std::vector<SnowScan> readSnowScans(const std::string& rawlog, const SnowSector& sector);

/// Snow by the plain measured law of Precipitation.h in place of a scan's own: as many flakes, each
/// beam alike and independent of the others, intensities by the sizes of the flakes at `mm_h`.
SnowScan plainSnow(const SnowScan& scan, double mm_h, const RngKey& key);

struct SnowRealismParams {
  SnowSector sector;
  std::size_t block = 5;    ///< scans in a row that train or test together
  std::size_t most = 3000;  ///< rows of a kind that train a forest
  double range_bin = 0.5;   ///< [m] of equal ranges
  double plain_mm_h = 2.5;  ///< rate whose flakes the control has
  std::uint64_t seed = 1;
};

/// Simulated scans and their name.
struct SnowLog {
  std::string name;
  std::vector<SnowScan> scans;
};

/// Whether a random forest tells simulated from recorded snow: trained on every other block of
/// scans, judged on the rest, and the reverse; area under the curve, the features that betray most.
StudyReport snowRealismStudy(const SnowRealismParams& params, const SnowLog& real,
                             const std::vector<SnowLog>& simulated);

}  // namespace perception
