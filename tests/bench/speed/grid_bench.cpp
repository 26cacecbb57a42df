// Safety grids on KITTI's HDL-64 (10 scans of 120k returns): ours in space and on the ground
// against octomap::OcTree, COctoMap, COccupancyGridMap3D and, on the ground, COccupancyGridMap2D
// fed with a virtual scan. Window 60 x 60 x 4 m, cells of .2 m, every return a hit, every beam
// clears. Scans outer, methods inner, CPU clock; and the cells of the same run compared with
// octomap's.
#include <fmt/format.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/COccupancyGridMap3D.h>
#include <mrpt/maps/COctoMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <octomap/OcTree.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/grid/SafetyGrid.h"
#include "tests/support/LabeledScans.h"

namespace perception {
namespace {

constexpr double kResolution = 0.2, kEdge = 60, kBottom = -0.4, kTop = 3.6;  // [m]
constexpr float kReach = 42.5F;  // [m] from the sensor to the window's corners
constexpr int kRepeats = 2;
constexpr double kSensorHeight = 1.73;  // [m]

double cpuMilliseconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

double residentMb() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return static_cast<double>(resident) * 4096 / 1e6;
}

GridParams windowParams(GridParams::BackEnd back_end) {
  GridParams params;
  params.back_end = back_end;
  params.resolution = kResolution, params.size = kEdge;
  params.z_min = kBottom, params.z_max = kTop, params.grade = 0;
  return params;
}

GridScan scanOf(const test::LabeledScan& scan, double t) {
  GridScan out;
  out.stamp = Stamp::fromSeconds(1000 + t);
  // Off the borders of cells, which two libraries may round to either side.
  out.origin = Vector3(0.013, 0.017, kSensorHeight + 0.011);
  const auto& cloud = std::get<LidarCloud>(scan.frame.data);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    out.hits.push_back(out.origin + Vector3(static_cast<double>(cloud.x[i]),
                                            static_cast<double>(cloud.y[i]),
                                            static_cast<double>(cloud.z[i])));
  return out;
}

struct Method {
  std::string name;
  std::function<void(const GridScan&)> insert;
  std::vector<double> ms;
};

/// octomap's answer: a beam is cut where it leaves the window's corners. (Its own bounding box
/// drops the beams that end outside.)
std::unique_ptr<octomap::OcTree> treeOf(const GridScan& scan) {
  auto tree = std::make_unique<octomap::OcTree>(kResolution);
  octomap::Pointcloud cloud;
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Vector3 p = scan.hits[i];
    cloud.push_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                    static_cast<float>(p.z()));
  }
  tree->insertPointCloud(
      cloud,
      octomap::point3d(static_cast<float>(scan.origin.x()), static_cast<float>(scan.origin.y()),
                       static_cast<float>(scan.origin.z())),
      -1, true);
  return tree;
}

/// How far two grids agree after one scan: intersection over union of occupied and of free cells.
void compareWithOctomap(const std::vector<GridScan>& scans) {
  double occupied[2] = {0, 0}, free[2] = {0, 0};  // intersection, union
  for (const GridScan& scan : scans) {
    const auto tree = treeOf(scan);
    const auto grid = makeSafetyGrid(windowParams(GridParams::BackEnd::kRolling));
    grid->insert(scan);
    for (double z = kBottom + kResolution / 2; z < kTop; z += kResolution)
      for (double y = -kEdge / 2 + kResolution / 2; y < kEdge / 2; y += kResolution)
        for (double x = -kEdge / 2 + kResolution / 2; x < kEdge / 2; x += kResolution) {
          const auto* node = tree->search(x, y, z);
          const double theirs = node ? static_cast<double>(node->getLogOdds()) : 0;
          const double ours = grid->logOdds({x, y, z});
          occupied[0] += theirs > 0 && ours > 0, occupied[1] += theirs > 0 || ours > 0;
          free[0] += theirs < 0 && ours < 0, free[1] += theirs < 0 || ours < 0;
        }
  }
  fmt::print("voxel IoU with octomap: occupied {:.4f}, free {:.4f}, both {:.4f}; goal .98\n",
             occupied[0] / occupied[1], free[0] / free[1],
             (occupied[0] + free[0]) / (occupied[1] + free[1]));
}

/// The same on the ground against the back end that follows each beam from cell to cell in doubles.
void compareOnTheGround(const std::vector<GridScan>& scans) {
  double occupied[2] = {0, 0}, free[2] = {0, 0};  // intersection, union
  GridParams params;
  for (const GridScan& scan : scans) {
    params.back_end = GridParams::BackEnd::kRolling2d;
    const auto ours = makeSafetyGrid(params);
    params.back_end = GridParams::BackEnd::kMrpt2d;
    const auto plain = makeSafetyGrid(params);
    ours->insert(scan), plain->insert(scan);
    const double half = params.size / 2, res = params.resolution;
    for (double y = -half + res / 2; y < half; y += res)
      for (double x = -half + res / 2; x < half; x += res) {
        const double a = ours->logOdds({x, y, 1}), b = plain->logOdds({x, y, 1});
        occupied[0] += a > 0 && b > 0, occupied[1] += a > 0 || b > 0;
        free[0] += a < 0 && b < 0, free[1] += a < 0 || b < 0;
      }
  }
  fmt::print("cells on the ground, IoU with beam by beam: occupied {:.4f}, free {:.4f}\n",
             occupied[0] / occupied[1], free[0] / free[1]);
}

mrpt::maps::CSimplePointsMap pointsOf(const GridScan& scan) {
  mrpt::maps::CSimplePointsMap points;
  points.reserve(scan.hits.size());
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Vector3 p = scan.hits[i];
    points.insertPoint(static_cast<float>(p.x()), static_cast<float>(p.y()),
                       static_cast<float>(p.z()));
  }
  return points;
}

/// The nearest obstacle of each direction, as a scan of 720 beams: how a grid on the ground is fed.
mrpt::obs::CObservation2DRangeScan virtualScan(const GridScan& scan) {
  mrpt::obs::CObservation2DRangeScan out;
  out.aperture = static_cast<float>(kTwoPi);
  out.maxRange = 80;
  out.resizeScan(720);
  std::vector<float> nearest(720, 80.F);
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Vector3 p = scan.hits[i];
    if (p.z() < 0.3 || p.z() > 3) continue;
    const double turn = (std::atan2(p.y(), p.x()) + kPi) / kTwoPi;
    float& r = nearest[std::min<std::size_t>(719, static_cast<std::size_t>(turn * 720))];
    r = std::min(r, static_cast<float>(std::hypot(p.x(), p.y())));
  }
  for (std::size_t i = 0; i < 720; ++i) {
    out.setScanRange(i, nearest[i]);
    out.setScanRangeValidity(i, nearest[i] < 80.F);
  }
  return out;
}

void report(std::vector<Method>& methods, const std::vector<std::size_t>& against) {
  for (const Method& m : methods)
    fmt::print("| {} | {:.2f} | {:.2f} |\n", m.name, quantile(m.ms, 0.5), quantile(m.ms, 0.99));
  for (const std::size_t peer : against) {
    std::vector<double> ratio;
    for (std::size_t i = 0; i < methods[0].ms.size(); ++i)
      ratio.push_back(methods[peer].ms[i] / methods[0].ms[i]);
    fmt::print("{} / ours: median {:.1f}, p1 {:.1f}\n", methods[peer].name, quantile(ratio, 0.5),
               quantile(ratio, 0.01));
  }
}

void timeThem(std::vector<Method>& methods, const std::vector<GridScan>& scans, int repeats) {
  double t = 0;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t i = 0; i < scans.size(); ++i)
      for (std::size_t k = 0; k < methods.size(); ++k) {
        Method& m = methods[(k + i) % methods.size()];  // order rotated
        GridScan scan = scans[i];
        t += 0.1 / static_cast<double>(methods.size());
        scan.stamp = Stamp::fromSeconds(1000 + t);
        const double begin = cpuMilliseconds();
        m.insert(scan);
        m.ms.push_back(cpuMilliseconds() - begin);
      }
}

void inSpace(const std::vector<GridScan>& scans) {
  const auto ours = makeSafetyGrid(windowParams(GridParams::BackEnd::kRolling));
  mrpt::maps::COccupancyGridMap3D flat({-30, -30, kBottom}, {30, 30, kTop},
                                       static_cast<float>(kResolution));
  mrpt::maps::COctoMap octo(kResolution);
  octo.insertionOptions.maxrange = kReach;
  std::vector<Method> methods;
  methods.push_back({"rolling", [&](const GridScan& s) { ours->insert(s); }, {}});
  methods.push_back({"COccupancyGridMap3D",
                     [&](const GridScan& s) {
                       const auto cloud = pointsOf(s);
                       const mrpt::math::TPoint3D o(s.origin.x(), s.origin.y(), s.origin.z());
                       flat.insertPointCloud({static_cast<float>(o.x), static_cast<float>(o.y),
                                              static_cast<float>(o.z)},
                                             cloud, kReach);
                     },
                     {}});
  methods.push_back({"octomap::OcTree", [&](const GridScan& s) { treeOf(s); }, {}});
  methods.push_back({"COctoMap",
                     [&](const GridScan& s) {
                       octo.insertPointCloud(pointsOf(s), static_cast<float>(s.origin.x()),
                                             static_cast<float>(s.origin.y()),
                                             static_cast<float>(s.origin.z()));
                     },
                     {}});
  timeThem(methods, scans, kRepeats);
  fmt::print("\nin space, ms CPU a scan of {} returns\n| | median | p99 |\n|---|---|---|\n",
             scans.front().hits.size());
  report(methods, {1, 2, 3});
  fmt::print("memory of rolling: {:.2f} MB; goal 5\n",
             static_cast<double>(ours->memoryBytes()) / 1e6);
}

/// Returns between .3 and 3 m are hits, all others only clear.
std::vector<GridScan> withoutGround(const std::vector<GridScan>& scans) {
  std::vector<GridScan> split = scans;
  for (GridScan& scan : split) {
    GridPoints hits;
    for (std::size_t i = 0; i < scan.hits.size(); ++i) {
      const Vector3 p = scan.hits[i];
      (p.z() > 0.3 && p.z() < 3 ? hits : scan.clear).push_back(p);
    }
    scan.hits = std::move(hits);
  }
  return split;
}

void onTheGround(const std::vector<GridScan>& scans) {
  GridParams params;
  params.back_end = GridParams::BackEnd::kRolling2d;
  const auto ours = makeSafetyGrid(params);
  mrpt::maps::COccupancyGridMap2D flat(-40, 40, -40, 40, 0.2F);
  flat.insertionOptions.maxDistanceInsertion = 40;
  std::vector<Method> methods;
  methods.push_back({"rolling2d", [&](const GridScan& s) { ours->insert(s); }, {}});
  methods.push_back({"COccupancyGridMap2D, virtual scan",
                     [&](const GridScan& s) { flat.insertObservation(virtualScan(s)); },
                     {}});
  const std::vector<GridScan> split = withoutGround(scans);
  compareOnTheGround(split);
  timeThem(methods, split, 10 * kRepeats);
  fmt::print("\non the ground, ms CPU a scan\n| | median | p99 |\n|---|---|---|\n");
  report(methods, {1});
  fmt::print("goal .5 ms\n");
}

/// A thousand scans while the vehicle drives on.
void memory(const std::vector<GridScan>& scans, const std::string& name) {
  if (scans.empty()) return;
  fmt::print(
      "\nmemory, 1000 scans at 10 m/s, {} {} looped\n| back end | MB after 100 | after 1000 | "
      "resident MB, growth |\n|---|---|---|---|\n",
      scans.size(), name);
  for (const auto back_end : {GridParams::BackEnd::kRolling, GridParams::BackEnd::kRolling2d}) {
    const auto grid = makeSafetyGrid(windowParams(back_end));
    std::size_t early = 0;
    double resident = 0;
    for (int i = 0; i < 1000; ++i) {
      GridScan scan = scans[static_cast<std::size_t>(i) % scans.size()];
      scan.stamp = Stamp::fromSeconds(1000 + 0.1 * i);
      const Vector3 moved(i, 0.1 * i, 0);
      scan.hits.shift(moved);
      scan.origin += moved, scan.T_world_ground.translation() += moved;
      grid->insert(scan);
      if (i == 100) early = grid->memoryBytes(), resident = residentMb();
    }
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n",
               back_end == GridParams::BackEnd::kRolling ? "rolling" : "rolling2d",
               static_cast<double>(early) / 1e6, static_cast<double>(grid->memoryBytes()) / 1e6,
               residentMb() - resident);
  }
}

std::vector<GridScan> recorded(const std::string& folder) {
  std::vector<GridScan> scans;
  const std::string dir = std::string(PERCEPTION_SHARED_DATA) + "/data/kitti_lidar_seq0000";
  for (const auto& scan : test::labeledScans(dir, kSensorHeight, 1000, folder))
    scans.push_back(scanOf(scan, 0));
  return scans;
}

int run() {
  const std::vector<GridScan> scans = recorded("velodyne_full");
  if (scans.empty()) {
    fmt::print("no recordings\n");
    return 0;
  }
  compareWithOctomap(scans);
  onTheGround(scans);
  memory(scans, "whole scans");
  memory(recorded("velodyne_front120"), "scans of the front 120 degrees");
  std::fflush(stdout);
  inSpace(scans);
  return 0;
}

}  // namespace
}  // namespace perception

int main() { return perception::run(); }
