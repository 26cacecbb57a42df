// Packets of real sensors with what others decode of them.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libperception/packets/Decoder.h"
#include "libperception/packets/GzipFile.h"
#include "libperception/packets/Pcap.h"

namespace perception {

inline std::string recordedFolder() {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/sensor_packets/";
}

#define SKIP_WITHOUT_RECORDINGS() \
  if (!std::filesystem::exists(recordedFolder())) GTEST_SKIP() << "no recorded sensor packets"

struct Place {
  float x, y, z;
};

/// Points of a binary PCD whose first three fields are x, y, z, of `stride` bytes each.
inline std::vector<Place> readTruth(const std::string& folder, std::size_t stride) {
  std::string path;
  for (const auto& entry : std::filesystem::directory_iterator(recordedFolder() + folder)) {
    if (entry.path().filename().string().rfind("truth_", 0) == 0) path = entry.path().string();
  }
  const std::string bytes = readPossiblyGzipped(path);
  const std::size_t begin = bytes.find("DATA binary\n") + 12;
  std::vector<Place> places((bytes.size() - begin) / stride);
  for (std::size_t i = 0; i < places.size(); ++i)
    std::memcpy(&places[i], bytes.data() + begin + i * stride, sizeof(Place));
  return places;
}

/// Distances from points to the nearest of a cloud, up to `reach`, by a grid of that size.
class NearestPlace {
 public:
  explicit NearestPlace(double reach) : reach_(reach) {}
  void add(const Place& p) { cells_[cellOf(p, 0, 0, 0)].push_back(p); }
  /// `reach` where there is none.
  double distance(const Place& p) const {
    double best = reach_;
    for (int i = 0; i < 27; ++i) {
      const auto cell = cells_.find(cellOf(p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      if (cell == cells_.end()) continue;
      for (const Place& q : cell->second)
        best = std::min(best, std::sqrt(std::pow(static_cast<double>(p.x) - q.x, 2) +
                                        std::pow(static_cast<double>(p.y) - q.y, 2) +
                                        std::pow(static_cast<double>(p.z) - q.z, 2)));
    }
    return best;
  }

 private:
  using Cell = std::array<long, 3>;
  Cell cellOf(const Place& p, int dx, int dy, int dz) const {
    return {std::lround(p.x / reach_) + dx, std::lround(p.y / reach_) + dy,
            std::lround(p.z / reach_) + dz};
  }
  double reach_;
  std::map<Cell, std::vector<Place>> cells_;
};

}  // namespace perception
