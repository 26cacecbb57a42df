// What point trust is worth behind the lidar: cells of the safety grid and clusters that falling
// snow makes in WADS sequence 36, without and with trust, on every back end.
#include <fmt/format.h>

#include "tests/support/SnowRun.h"

namespace perception {
namespace {

int run() {
  const auto scans =
      test::labelledScans(std::string(PERCEPTION_SHARED_DATA) + "/data/wads_snow", 2.17);
  if (scans.empty()) {
    fmt::print("no recordings\n");
    return 0;
  }
  fmt::print("WADS 36, {} scans with their poses; sums over scans\n\n", scans.size());
  fmt::print(
      "| back end | intensity | cells of snow alone within 15 m, without | with | ratio | car and "
      "person cells | kept | kept of those without snow | clusters of snow a scan, without | with "
      "| all clusters | with |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const char* names[] = {"octomap", "mrpt2d", "mrpt3d", "rolling", "rolling2d"};
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
          "| {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.0f} | {:.2f} % | {:.2f} % | {:.2f} | {:.2f} | "
          "{:.1f} | {:.1f} |\n",
          names[static_cast<std::size_t>(back_end)], intensity ? "used" : "hidden", sum.plain_cells,
          sum.trusted_cells, sum.fewer(), sum.user_cells, 100 * sum.kept(), 100 * sum.cleanKept(),
          sum.plain_clusters / count, sum.trusted_clusters / count, sum.plain_all / count,
          sum.trusted_all / count);
      std::fflush(stdout);
    }
  return 0;
}

}  // namespace
}  // namespace perception

int main() { return perception::run(); }
