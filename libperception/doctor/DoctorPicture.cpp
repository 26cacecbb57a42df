#include "libperception/doctor/DoctorPicture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/plots/Gnuplot.h"

namespace perception {
namespace {

constexpr std::size_t kMostPoints = 20000;  ///< drawn of a scan: more only cover each other
constexpr std::size_t kMostStamps = 4000;   ///< drawn of a label

constexpr const char* kScript = R"(set multiplot layout 2,2 title {title} noenhanced
unset key
set title 'observations over time'
set xlabel 'time since the first frame (s)'
set ytics ({tics}) noenhanced
set yrange [-0.5:{labels}-0.5]
plot 'stamps.txt' using 1:2 with points pt 5 ps 0.4 lc rgb '#0072B2'
set ytics autofreq
set yrange [*:*]
set title {scan} noenhanced
set size ratio -1
set xrange [-50:50]
set yrange [-50:50]
set xlabel 'x ahead (m)'
set ylabel 'y left (m)'
plot 'scan.txt' using 1:2:($3<0.3?0xBBBBBB:0x0072B2) with dots lc rgb variable
set size noratio
set title 'from the side: gray line z = 0 of the log{found}'
set xrange [-50:50]
set yrange [-3:5]
set ylabel 'z (m), vehicle frame of the log'
plot 'scan.txt' using 1:4 with dots lc rgb '#0072B2', 0 lc rgb '#888888' lw 2{ground}
set title 'ego motion by poses and by odometry from lidars'
set xrange [*:*]
set yrange [*:*]
set xlabel 'time since the first frame (s)'
set ylabel 'yaw rate (deg/s)'
set y2label 'speed (m/s)'
set y2tics
set ytics nomirror
set key top right inside noenhanced
plot {motion}
unset multiplot
)";

Stamp firstOf(const LogSurvey& survey) {
  Stamp first;
  const auto take = [&first](Stamp stamp) {
    if (first.ns == 0 || stamp < first) first = stamp;
  };
  for (const auto& [label, facts] : survey.sensors())
    for (const Stamp& stamp : facts.stamps) take(stamp);
  for (const auto& [label, poses] : survey.poses())
    for (const auto& pose : poses) take(pose.stamp);
  return first;
}

std::string scanText(const SensorFrame& frame, const GroundPlane& plane) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  std::string text;
  if (cloud == nullptr) return text;
  const std::size_t every = cloud->size() / kMostPoints + 1;
  for (std::size_t i = 0; i < cloud->size(); i += every) {
    const Vector3 p = frame.T_ego_sensor * Vector3(static_cast<double>(cloud->x[i]),
                                                   static_cast<double>(cloud->y[i]),
                                                   static_cast<double>(cloud->z[i]));
    text += fmt::format("{:.2f} {:.2f} {:.2f} {:.2f}\n", p.x(), p.y(),
                        p.z() - plane.heightAt(p.x(), p.y()), p.z());
  }
  return text;
}

/// t, yaw rate [deg/s], speed [m/s] between poses.
std::string motionText(const std::vector<EgoState>& poses, Stamp first) {
  std::string text;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const EgoState &a = poses[i - 1], &b = poses[i];
    const double dt = b.stamp - a.stamp;
    if (dt <= 0) continue;
    const double turn = wrapAngle(yawOf(b.T_world_ego) - yawOf(a.T_world_ego));
    const Vector3 step = b.T_world_ego.translation() - a.T_world_ego.translation();
    text += fmt::format("{:.3f} {:.4f} {:.4f}\n", b.stamp - first - dt / 2, degrees(turn / dt),
                        step.norm() / dt);
  }
  return text;
}

}  // namespace

StudyPlot doctorPicture(const LogSurvey& survey) {
  const Stamp first = firstOf(survey);
  std::string stamps, tics, motion = "0 lc rgb '#888888' notitle";
  int row = 0;
  const auto addRow = [&](const std::string& label, const auto& items, const auto& stampOf) {
    const std::size_t every = items.size() / kMostStamps + 1;
    for (std::size_t i = 0; i < items.size(); i += every)
      stamps += fmt::format("{:.3f} {}\n", stampOf(items[i]) - first, row);
    tics += fmt::format("{}{} {}", row == 0 ? "" : ", ", gnuplotString(label), row);
    ++row;
  };
  for (const auto& [label, facts] : survey.sensors())
    addRow(label, facts.stamps, [](Stamp stamp) { return stamp; });
  const auto addMotion = [&](const std::string& label, const std::vector<EgoState>& poses,
                             StudyPlot& plot) {
    const std::string file = fmt::format("poses{}.txt", plot.data.size());
    plot.data.emplace_back(file, motionText(poses, first));
    motion += fmt::format(
        ", '{0}' using 1:2 with lines lw 2 title {1}, '{0}' using 1:3 axes x1y2 "
        "with lines dt 2 title 'its speed'",
        file, gnuplotString(label));
  };
  StudyPlot plot;
  plot.name = "doctor", plot.caption = "Stamps, a scan from above and from the side, ego motion";
  plot.width = 1400, plot.height = 900;
  for (const auto& [label, poses] : survey.poses()) {
    addRow(label, poses, [](const EgoState& pose) { return pose.stamp; });
    addMotion(label, poses, plot);
  }
  for (const auto& [label, facts] : survey.sensors())
    if (facts.odometry.size() > 1) addMotion("odometry from " + label, facts.odometry, plot);
  GroundPlane plane;
  std::string scan, found = ", no ground found", ground;
  if (const auto& sample = survey.sample()) {
    const SensorFacts& facts = survey.sensors().at(sample->sensor);
    if (const auto mounting = groundMounting(facts); mounting && !facts.planar) {
      plane = mounting->plane;
      found = ", red the ground found";
      ground = fmt::format(", {}*x+{} lc rgb '#D55E00' lw 2", plane.a, plane.c);
    }
    scan = scanText(*sample, plane);
  }
  // Never empty: gnuplot would stop at a file without points.
  plot.data.emplace_back("scan.txt", scan.empty() ? "0 0 0 0\n" : scan);
  plot.data.emplace_back("stamps.txt", stamps.empty() ? "0 0\n" : stamps);
  const auto& sample = survey.sample();
  plot.script = fmt::format(
      kScript, fmt::arg("title", gnuplotString("what the log holds")), fmt::arg("tics", tics),
      fmt::arg("labels", std::max(row, 1)),
      fmt::arg("scan", gnuplotString(sample ? "last scan of " + sample->sensor + ", ground gray"
                                            : "no lidar")),
      fmt::arg("found", found), fmt::arg("ground", ground), fmt::arg("motion", motion));
  return plot;
}

}  // namespace perception
