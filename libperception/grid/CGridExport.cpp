#include "libperception/grid/CGridExport.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <mrpt/img/CImage.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>
#include <octomap/OcTree.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string_view>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The highest log-odds of each ground cell, or the lowest where none is above 0.
std::map<std::pair<int, int>, double> groundOf(const std::vector<GridCell>& cells,
                                               double resolution, const Vector2& corner) {
  std::map<std::pair<int, int>, double> ground;
  for (const GridCell& cell : cells) {
    const Vector2 place = (cell.center.head<2>() - corner) / resolution;
    const auto [at, fresh] = ground.try_emplace(
        {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))},
        cell.log_odds);
    if (!fresh && (cell.log_odds > 0 ? cell.log_odds > at->second
                                     : at->second < 0 && cell.log_odds < at->second))
      at->second = cell.log_odds;
  }
  return ground;
}

/// Formats are made in memory, since neither OctoMap nor MRPT reports a full disk. A file of this
/// name is whole or absent.
void writeWhole(const std::string& path, std::string_view bytes) {
  PartialFile partial(path);
  const auto fail = [&path](ExitCode code) {
    throw OutputError(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)), code);
  };
  const int file = ::open(partial.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(ExitCode::kCannotCreate);
  bool good = true;
  while (good && !bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    good = written > 0 || (written < 0 && errno == EINTR);
    bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
  good = good && (::fsync(file) == 0 || errno == EINVAL);
  const int reason = good ? 0 : errno;
  good = ::close(file) == 0 && good;
  if (reason != 0) errno = reason;
  if (!good) fail(ExitCode::kIoError);
  partial.commit();
}

std::string gzipped(const mrpt::io::CMemoryStream& bytes) {
  z_stream z{};
  z.next_in = static_cast<Bytef*>(const_cast<void*>(bytes.getRawBufferData()));
  z.avail_in = static_cast<uInt>(bytes.getTotalBytesCount());
  if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string out(deflateBound(&z, z.avail_in), '\0');
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int end = deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  if (end != Z_STREAM_END) throw Error(ExitCode::kInternal, "a grid cannot be compressed");
  return out;
}

std::string pngOf(const mrpt::maps::COccupancyGridMap2D& map) {
  mrpt::img::CImage image;
  map.getAsImage(image);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image.asCvMatRef(), bytes))
    throw Error(ExitCode::kInternal, "a grid cannot be drawn");
  return {bytes.begin(), bytes.end()};
}

std::string octreeFile(const SafetyGrid& grid, const std::string& name) {
  octomap::OcTree tree(grid.params().resolution);
  tree.setClampingThresMin(octomap::probability(grid.params().low));
  tree.setClampingThresMax(octomap::probability(grid.params().high));
  for (const GridCell& cell : grid.knownCells())
    tree.setNodeValue(cell.center.x(), cell.center.y(), cell.center.z(),
                      static_cast<float>(cell.log_odds), true);
  tree.updateInnerOccupancy();
  tree.prune();
  std::ostringstream bytes;
  bytes.exceptions(std::ios::badbit);  // a lack of memory is no end
  const bool made = endsWith(name, ".bt") ? tree.writeBinary(bytes) : tree.write(bytes);
  if (!made || !bytes) throw Error(ExitCode::kInternal, name + ": OctoMap does not write the tree");
  return bytes.str();
}

std::string groundFile(const SafetyGrid& grid, const std::string& name) {
  const auto cells = grid.knownCells();
  const double resolution = grid.params().resolution;
  Vector2 low(-1, -1), high(1, 1);  // [m] a small empty map when no cell is known
  if (!cells.empty()) low = high = cells.front().center.head<2>();
  for (const GridCell& cell : cells) {
    low = low.cwiseMin(cell.center.head<2>()), high = high.cwiseMax(cell.center.head<2>());
  }
  const Vector2 corner = low - Vector2::Constant(resolution / 2);
  high += Vector2::Constant(resolution / 2);
  mrpt::maps::COccupancyGridMap2D map(static_cast<float>(corner.x()), static_cast<float>(high.x()),
                                      static_cast<float>(corner.y()), static_cast<float>(high.y()),
                                      static_cast<float>(resolution));
  for (const auto& [place, log_odds] : groundOf(cells, resolution, corner))
    map.setCell(place.first, place.second, static_cast<float>(1 / (1 + std::exp(log_odds))));
  if (endsWith(name, ".png")) return pngOf(map);
  mrpt::io::CMemoryStream bytes;
  mrpt::serialization::archiveFrom(bytes) << map;
  return gzipped(bytes);
}

}  // namespace

std::string gridFileOf(const SafetyGrid& grid, const std::string& name) {
  if (endsWith(name, ".ot") || endsWith(name, ".bt")) return octreeFile(grid, name);
  if (endsWith(name, ".gridmap.gz") || endsWith(name, ".png")) return groundFile(grid, name);
  throw Error(ExitCode::kUsage, name + ": expected a grid as .ot, .bt, .gridmap.gz or .png");
}

void saveGrid(const SafetyGrid& grid, const std::string& file) {
  writeWhole(file, gridFileOf(grid, file));
}

}  // namespace perception
