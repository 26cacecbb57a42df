#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/ImportText.h"

namespace perception {

/// DIR/labels/STEM.label[.gz] of a scan in SemanticKITTI's layout: a uint32 a point, the class in
/// the lower half, the instance in the upper one. The file is copied as it is into
/// labelFolderOf(). Empty: there is none, which is reported to the log. Throws DataError,
/// OutputError.
std::vector<std::uint32_t> keepPointLabels(const std::string& dir, const FrameFile& scan,
                                           std::size_t points, ImportLog& log);

}  // namespace perception
