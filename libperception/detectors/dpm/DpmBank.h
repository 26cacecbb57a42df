#pragma once
#include <utility>
#include <vector>

#include "libperception/detectors/AlignedFloats.h"
#include "libperception/detectors/dpm/DpmEngine.h"
#include "libperception/detectors/simd/VisionKernels.h"

namespace perception {

/// Models prepared for the engine's kernels: parts in groups, as spectra.
struct DpmBank {
  /// A part as one filter of a group.
  struct Lane {
    int component = -1, part = -1;
    std::size_t parity = 0;  ///< of its anchor, an index into Group::parities
  };
  /// 2 * lanes filters convolved together.
  struct Group {
    std::vector<Lane> lanes;
    std::vector<std::pair<int, int>> parities;  ///< of anchors' columns and rows: 0 or 1
    AlignedFloats weights;                      ///< see VisionKernels::products
    AlignedFloats costs_x, costs_y;             ///< (2 window + 1) x 2 lanes
  };

  std::vector<DpmTarget> targets;
  DpmOptions options;
  const VisionKernels& kernels;
  std::vector<std::vector<Group>> groups;  ///< per target
  int cell = 8;                            ///< [px]
  int valid = kPatch;                      ///< [cells] side of a patch that is valid for all parts

  /// Throws DataError for models that cannot share a pyramid, or with parts that are too large.
  DpmBank(std::vector<DpmTarget> targets, DpmOptions options, SimdLevel level);

  /// Anchor in root cells: floor(a / 2), negative numbers included.
  static int halfOf(int anchor) { return anchor >= 0 ? anchor / 2 : -((1 - anchor) / 2); }

 private:
  void addGroups(const DpmTarget& target);
  Group makeGroup(const DpmTarget& target, const std::vector<Lane>& lanes) const;
};

}  // namespace perception
