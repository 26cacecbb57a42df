#pragma once
#include <zstd.h>

#include <string>

namespace perception {

/// One zstd frame that tells its size.
inline std::string zstdOf(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

}  // namespace perception
