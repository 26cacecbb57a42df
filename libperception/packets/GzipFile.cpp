#include "libperception/packets/GzipFile.h"

#include <zlib.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "libperception/core/Error.h"

namespace perception {

std::string readPossiblyGzipped(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw DataError(path + ": no such file", ExitCode::kNoInput);
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), &gzclose);
  if (!file) throw DataError(path + ": cannot be read", ExitCode::kNoInput);
  std::string bytes;
  std::vector<char> part(1U << 20);
  int count = 0;
  while ((count = gzread(file.get(), part.data(), static_cast<unsigned>(part.size()))) > 0)
    bytes.append(part.data(), static_cast<std::size_t>(count));
  if (count < 0) throw DataError(path + ": damaged gzip file");
  return bytes;
}

}  // namespace perception
