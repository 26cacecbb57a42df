// What point trust is worth behind the lidar: cells of the safety grid and clusters that falling
// snow makes in WADS sequence 36, without and with trust, on every back end.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <sstream>

#include "libperception/core/math/Angle.h"
#include "tests/support/SnowRun.h"

namespace perception {
namespace {

/// RADIATE's lidar in fog (32 beams, columns x y z intensity ring, x to the right): no labels and
/// no poses, so only what the filter doubts and how many clusters are left.
void fog() {
  namespace fs = std::filesystem;
  const std::string dir = std::string(PERCEPTION_SHARED_DATA) + "/data/radiate_fog/velo_lidar";
  if (!fs::is_directory(dir)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  WeatherParams off, on;
  on.filter = "trust";
  test::SnowRun plain(off, {}), trusted(on, {});
  double clusters = 0, left = 0, share = 0;
  double returns[4] = {}, doubted[4] = {};  // by 10 m of range
  for (std::size_t k = 0; k < files.size(); ++k) {
    SensorFrame frame;
    frame.sensor = "LIDAR_TOP";
    frame.stamp = Stamp::fromSeconds(1000 + 0.1 * static_cast<double>(k));
    frame.T_ego_sensor = makePose(0, 0, 2.05, -kPi / 2);
    LidarCloud cloud;
    std::istringstream lines(test::gunzip(files[k].string()));
    for (std::string line; std::getline(lines, line);) {
      float x = 0, y = 0, z = 0, intensity = 0;
      if (std::sscanf(line.c_str(), "%f,%f,%f,%f", &x, &y, &z, &intensity) != 4) continue;
      cloud.x.push_back(x), cloud.y.push_back(y), cloud.z.push_back(z);
      cloud.intensity.push_back(intensity / 255);
    }
    frame.data = std::move(cloud);
    plain.add(frame, {}), trusted.add(frame, {});
    clusters += static_cast<double>(plain.clusters());
    left += static_cast<double>(trusted.clusters());
    const auto& seen = std::get<LidarCloud>(trusted.frame().data);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const float r = std::hypot(seen.x[i], seen.y[i], seen.z[i]);
      const auto bin = std::min<std::size_t>(3, static_cast<std::size_t>(r / 10));
      returns[bin] += 1, doubted[bin] += seen.trust[i] < 0.5F;
      share += seen.trust[i] < 0.5F;
    }
  }
  const auto count = static_cast<double>(files.size());
  fmt::print(
      "\nRADIATE, real fog, {} scans: clusters a scan {:.2f} without, {:.2f} with trust; {:.1f} "
      "returns a scan doubted\n| range | returns | doubted |\n|---|---|---|\n",
      files.size(), clusters / count, left / count, share / count);
  for (int bin = 0; bin < 4; ++bin)
    fmt::print("| {} | {:.0f} | {:.3f} % |\n",
               bin < 3 ? fmt::format("{} to {} m", 10 * bin, 10 * bin + 10) : "beyond",
               returns[bin], 100 * doubted[bin] / std::max(1.0, returns[bin]));
}

int run() {
  fog();
  const auto scans =
      test::labeledScans(std::string(PERCEPTION_SHARED_DATA) + "/data/wads_snow", 2.17);
  if (scans.empty()) {
    fmt::print("no recordings\n");
    return 0;
  }
  fmt::print("WADS 36, {} scans with their poses; sums over scans\n\n", scans.size());
  fmt::print(
      "| back end | intensity | cells of snow alone within 15 m, without | with | ratio | car and "
      "person cells | kept | on even scans | kept of those without snow | clusters of snow a scan, "
      "without | with "
      "| all clusters | with |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const char* names[] = {"octomap", "mrpt2d", "rolling", "rolling2d"};
  for (const auto back_end : {GridParams::BackEnd::kRolling, GridParams::BackEnd::kOctomap,
                              GridParams::BackEnd::kRolling2d})
    for (const bool intensity : {true, false}) {
      WeatherParams weather;
      weather.filter = "trust", weather.trust.use_intensity = intensity;
      GridParams grid;
      grid.back_end = back_end;
      const auto sum = test::compareInSnow(scans, weather, grid);
      const auto count = static_cast<double>(sum.scans);
      fmt::print(
          "| {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.0f} | {:.2f} % | {:.2f} % | {:.2f} % | {:.2f} "
          "| {:.2f} | "
          "{:.1f} | {:.1f} |\n",
          names[static_cast<std::size_t>(back_end)], intensity ? "used" : "hidden", sum.plain_cells,
          sum.trusted_cells, sum.fewer(), sum.user_cells, 100 * sum.kept(), 100 * sum.evenKept(),
          100 * sum.cleanKept(), sum.plain_clusters / count, sum.trusted_clusters / count,
          sum.plain_all / count, sum.trusted_all / count);
      std::fflush(stdout);
    }
  return 0;
}

}  // namespace
}  // namespace perception

int main() { return perception::run(); }
