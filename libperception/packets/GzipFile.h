#pragma once
#include <string>

namespace perception {

/// A file's bytes, inflated where it is a gzip file. Throws DataError (kNoInput when missing).
std::string readPossiblyGzipped(const std::string& path);

}  // namespace perception
