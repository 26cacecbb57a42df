#include "libperception/importers/truth/PointLabelFiles.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"

namespace perception {
namespace fs = std::filesystem;

std::vector<std::uint32_t> keepPointLabels(const std::string& dir, const FrameFile& scan,
                                           std::size_t points, ImportLog& log) {
  const std::string labels = (fs::path(dir) / "labels").string();
  const std::string path = fileOfStem(labels, scan.stem, {".label", ".label.gz"});
  if (path.empty()) {
    log.missing("labels", labels, scan.number);
    return {};
  }
  const std::string bytes = readBytes(path);
  if (bytes.size() != sizeof(std::uint32_t) * points) {
    throw DataError(fmt::format("{}: {} bytes, expected 4 (uint32) for each of the {} points of {}",
                                path, bytes.size(), points, scan.path));
  }
  std::vector<std::uint32_t> all(points);
  std::memcpy(all.data(), bytes.data(), bytes.size());
  const std::string folder = labelFolderOf(log.options().output);
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path to = fs::path(folder) / fs::path(path).filename();
  if (!error) fs::copy_file(path, to, fs::copy_options::overwrite_existing, error);
  if (error) throw OutputError(fmt::format("{}: cannot copy: {}", to.string(), error.message()));
  return all;
}

}  // namespace perception
