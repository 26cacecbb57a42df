#include "libperception/calibration/clusters/PointLabels.h"

#include <fmt/format.h>
#include <zlib.h>

#include <charconv>
#include <cstring>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"

namespace perception {

namespace fs = std::filesystem;

bool isPhantomLabel(std::uint16_t label) { return label == 110 || (label >= 112 && label <= 118); }

PointLabels::PointLabels(const std::string& rawlog) {
  const std::string folder = labelFolderOf(rawlog);
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    std::int64_t frame = -1;
    const auto read = std::from_chars(name.data(), name.data() + name.size(), frame);
    if (read.ec == std::errc() && std::string(read.ptr).rfind(".label", 0) == 0)
      files_[frame] = entry.path().string();
  }
}

std::optional<std::vector<std::uint16_t>> PointLabels::ofFrame(std::int64_t frame,
                                                               std::size_t points) const {
  const auto found = files_.find(frame);
  if (found == files_.end()) return std::nullopt;
  const std::string& path = found->second;
  std::vector<std::uint32_t> labels(points + 1);   // one more tells a longer file
  const gzFile file = gzopen(path.c_str(), "rb");  // reads plain files, too
  if (!file) throw DataError(path + ": cannot be opened");
  const auto wanted = static_cast<unsigned>(labels.size() * sizeof(labels[0]));
  const int got = gzread(file, labels.data(), wanted);
  if (gzclose(file) != Z_OK || got < 0) throw DataError(path + ": bad or cut gzip data");
  if (static_cast<std::size_t>(got) != 4 * points)
    throw DataError(fmt::format("{}: expected {} labels, one uint32 for each point of frame {}",
                                path, points, frame));
  std::vector<std::uint16_t> classes(points);
  for (std::size_t i = 0; i < points; ++i)
    classes[i] = static_cast<std::uint16_t>(labels[i] & 0xffff);
  return classes;
}

}  // namespace perception
