#pragma once
#include <string>

#include "libperception/detectors/dpm/DpmModel.h"

namespace perception {

/// Reads a star model of voc-release4 or voc-release5 from a MATLAB file
/// (variable `model`). Throws DataError with file and field.
DpmModel readDpmMatFile(const std::string& path);

}  // namespace perception
