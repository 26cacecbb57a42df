#include "studies/motion/HeadingStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "studies/motion/HeadingScene.h"

namespace perception {
namespace {

using namespace heading_scene;

constexpr double kLostAfter = 1.5;  // [s] without an accepted measurement
constexpr double kGate = 11.34;     // chi-square .99, three degrees of freedom
constexpr std::uint32_t kHeadingPurpose = 0x5720;

ObjectClass carClass() {
  ObjectClass c;
  c.motion = findMotionModel("wheeled");
  c.accel_psd = 0.6;
  c.yaw_rate_psd = radians(15) * radians(15);
  c.position_psd = 0.01;
  return c;
}

/// One track of one method.
class HeadingTrack {
 public:
  HeadingTrack(const HeadingMethod& method, double flip) : method_(method), flip_(flip) {}

  bool alive() const { return alive_; }
  const ClassFilter& filter() const { return filter_; }
  int rejected() const { return rejected_; }
  int lost() const { return lost_; }

  void step(double t, const Seen& seen) {
    if (alive_) predictClassFilter(carClass(), kStep, filter_);
    if (seen.camera) camera(t, *seen.camera);
    if (seen.radar && alive_) radar(t, *seen.radar);
    if (alive_ && t - last_ > kLostAfter) alive_ = false, ++lost_;
  }

 private:
  MeasuredHeading heading(double yaw) const { return {yaw, kAxisSigma, flip_}; }

  void start(double t, const Vector3& z) {
    filter_ = ClassFilter();
    const Vector2 u(std::cos(z[0]), std::sin(z[0])), n(-u.y(), u.x());
    const double sigma = 0.06 * z[1] + 0.2;
    filter_.x << z[1] * u, 0, wrapAngle(z[2]);
    filter_.P.topLeftCorner<2, 2>() =
        sigma * sigma * u * u.transpose() + std::pow(z[1] * kBearingSigma, 2) * n * n.transpose();
    filter_.P(2, 2) = 16;
    filter_.P(3, 3) = headingResidual(heading(z[2]), z[2], method_.mode).variance;
    filter_.oriented = true;
    filter_.heading = firstFrontBack(heading(z[2]));
    last_ = t;
    alive_ = true;
  }

  /// One scalar after another: equal to the joint update for independent axes.
  static double scalar(const Eigen::RowVector4d& H, double y, double R, ClassFilter& f) {
    const double S = H * f.P * H.transpose() + R;
    const Vector4 K = f.P * H.transpose() / S;
    f.x += K * y;
    f.P = (f.P - K * S * K.transpose()).eval();
    f.P = (0.5 * (f.P + f.P.transpose())).eval();
    return y * y / S;
  }

  /// Several axes linearized about one state.
  template <int kAxes>
  static double joint(const Eigen::Matrix<double, kAxes, 4>& H,
                      const Eigen::Matrix<double, kAxes, 1>& y,
                      const Eigen::Matrix<double, kAxes, 1>& R, ClassFilter& f) {
    const Vector4 before = f.x;
    double nis = 0;
    for (int a = 0; a < kAxes; ++a) {
      Vector4 moved = f.x - before;
      nis += scalar(H.row(a), y[a] - H.row(a).dot(moved), R[a], f);
    }
    f.x[3] = wrapAngle(f.x[3]);
    return nis;
  }

  void camera(double t, const Vector3& z) {
    if (!alive_) return start(t, z);
    ClassFilter f = filter_;
    const double r = f.x.head<2>().norm(), b = std::atan2(f.x[1], f.x[0]);
    Eigen::Matrix<double, 3, 4> H = Eigen::Matrix<double, 3, 4>::Zero();
    H.row(0) << -f.x[1] / (r * r), f.x[0] / (r * r), 0, 0;
    H.row(1) << f.x[0] / r, f.x[1] / r, 0, 0;
    H(2, 3) = 1;
    HeadingResidual heading_residual = headingResidual(heading(z[2]), f.x[3], method_.mode);
    if (method_.naive) heading_residual.y = wrapAngle(z[2] - f.x[3]);
    const Vector3 y(wrapAngle(z[0] - b), z[1] - r, heading_residual.y);
    const Vector3 R(kBearingSigma * kBearingSigma, std::pow(0.06 * z[1] + 0.2, 2),
                    heading_residual.variance);
    if (joint<3>(H, y, R, f) > kGate) {
      ++rejected_;
      return;
    }
    f.heading = nextFrontBack(f.heading, heading_residual.same, heading(z[2]));
    if (!method_.naive && asksForReversal(f.heading, f.x[2], f.P(2, 2), method_.mode)) reverse(f);
    filter_ = f;
    last_ = t;
  }

  void radar(double t, const Vector3& z) {
    ClassFilter f = filter_;
    const Kinematics k = kinematicsOf(carClass(), f);
    const Vector2 p = k.q.head<2>(), v = k.q.segment<2>(2);
    const double r = p.norm();
    const Vector2 u = p / r;
    const double rate = u.dot(v);
    Eigen::Matrix<double, 3, 5> Hq = Eigen::Matrix<double, 3, 5>::Zero();
    Hq.row(0).head<2>() = u.transpose();
    Hq.row(1).head<2>() << -p.y() / (r * r), p.x() / (r * r);
    Hq.row(2).head<2>() = (v - rate * u).transpose() / r;
    Hq.row(2).segment<2>(2) = u.transpose();
    const Eigen::Matrix<double, 3, 4> H = Hq * k.J;
    const Vector3 y(z[0] - r, wrapAngle(z[1] - std::atan2(p.y(), p.x())), z[2] - rate);
    if (joint<3>(H, y, Vector3(0.5, std::pow(radians(3), 2), 0.09), f) > kGate) {
      ++rejected_;
      return;
    }
    filter_ = f;
    last_ = t;
  }

  HeadingMethod method_;
  double flip_;
  ClassFilter filter_;
  bool alive_ = false;
  double last_ = 0;
  int rejected_ = 0, lost_ = 0;
};

HeadingFigures oneRun(const HeadingMethod& method, bool radar, double flip, std::uint64_t seed,
                      std::uint64_t run) {
  Rng rng({seed, run, 0, kHeadingPurpose});
  const auto path = drive(rng);
  const auto seen = sense(path, radar, flip, rng);
  HeadingTrack track(method, flip);
  HeadingFigures f;
  double instants = 0, estimated = 0, tracked = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    track.step(kStep * static_cast<double>(k), seen[k]);
    if (!seen[k].in_view) continue;
    ++instants;
    if (!track.alive()) continue;
    ++estimated;
    const Kinematics q = kinematicsOf(carClass(), track.filter());
    const double error = (q.q.head<2>() - path[k].p).norm();
    if (error < 2) ++tracked, f.position_rms += error * error;
    const double heading = std::abs(wrapAngle(q.q[4] - path[k].heading));
    f.heading_rms += heading * heading;
    f.right_way += heading < kPi / 2 ? 1 : 0;
    const Vector2 v = path[k].v * Vector2(std::cos(path[k].heading), std::sin(path[k].heading));
    f.velocity_rms += (q.q.segment<2>(2) - v).squaredNorm();
  }
  f.tracked = tracked / std::max(1.0, instants);
  f.position_rms = std::sqrt(f.position_rms / std::max(1.0, tracked));
  f.heading_rms = std::sqrt(f.heading_rms / std::max(1.0, estimated));
  f.right_way /= std::max(1.0, estimated);
  f.velocity_rms = std::sqrt(f.velocity_rms / std::max(1.0, estimated));
  f.lost = track.lost();
  f.rejected = track.rejected();
  return f;
}

}  // namespace

const std::vector<HeadingMethod>& headingMethods() {
  static const std::vector<HeadingMethod> methods = {
      {"every heading right", HeadingMode::kSplit, true},
      {"one wide Gaussian (C/H)", HeadingMode::kWide, false},
      {"split, log-odds and driving direction", HeadingMode::kSplit, false},
  };
  return methods;
}

HeadingFigures runHeading(const HeadingMethod& method, bool radar, double flip_probability,
                          const HeadingParams& params) {
  std::vector<HeadingFigures> runs(static_cast<std::size_t>(params.runs));
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    runs[i] = oneRun(method, radar, flip_probability, params.seed, i);
  });
  HeadingFigures sum;
  const double share = 1.0 / static_cast<double>(params.runs);
  for (const auto& r : runs) {
    sum.tracked += share * r.tracked;
    sum.position_rms += share * r.position_rms;
    sum.heading_rms += share * r.heading_rms;
    sum.right_way += share * r.right_way;
    sum.velocity_rms += share * r.velocity_rms;
    sum.lost += share * r.lost;
    sum.rejected += share * r.rejected;
  }
  return sum;
}

namespace {

std::vector<std::string> rowOf(double flip_probability, const std::string& method,
                               const HeadingFigures& f) {
  return {fmt::format("{:.2f}", flip_probability), method,
          fmt::format("{:.3f}", f.tracked),        fmt::format("{:.3f}", f.position_rms),
          fmt::format("{:.3f}", f.heading_rms),    fmt::format("{:.3f}", f.right_way),
          fmt::format("{:.2f}", f.velocity_rms),   fmt::format("{:.2f}", f.lost),
          fmt::format("{:.2f}", f.rejected)};
}

}  // namespace

StudyReport headingStudy(const HeadingParams& params) {
  StudyReport report;
  report.title = "Headings that confuse front and back";
  report.data = fmt::format(
      "simulated: one car that stops, goes on and may turn, camera 5 Hz (60 % detected to 15 m, "
      "axis 8 degrees), radar 2 Hz; {} runs, seed {}",
      params.runs, params.seed);
  for (const bool radar : {true, false}) {
    StudyTable t;
    t.name = radar ? "camera_and_radar" : "camera";
    t.title = radar ? "Camera and radar" : "Camera alone";
    t.columns = {"reversed",
                 "method",
                 "tracked",
                 "position rms [m]",
                 "heading rms [rad]",
                 "right way",
                 "velocity rms [m/s]",
                 "lost a run",
                 "rejected a run"};
    StudyPlot plot;
    plot.name = std::string("heading_") + t.name;
    plot.caption = t.title + ": mean over simulated runs, by the share of reversed headings.";
    plot.width = 1000, plot.height = 450;
    plot.script =
        "set multiplot layout 1,2 title 'simulated car'\nset grid\nset xlabel 'share reversed'\n";
    std::string tracked = "set key off\nset ylabel 'instants tracked'\nset yrange [*:*]\nplot ",
                way =
                    "set key bottom left\nset ylabel 'heading error below 90 degrees'\n"
                    "set yrange [0:1.02]\nplot ";
    std::size_t column = 0;
    for (const auto& method : headingMethods()) {
      const std::string file = fmt::format("heading_{}_{}.dat", t.name, column);
      std::string data;
      for (const double p : params.flip_probabilities) {
        const auto f = runHeading(method, radar, p, params);
        t.rows.push_back(rowOf(p, method.label, f));
        data += fmt::format("{} {:.4f} {:.4f}\n", p, f.tracked, f.right_way);
      }
      plot.data.push_back({file, data});
      const std::string style =
          fmt::format("with linespoints lw 2 title {} noenhanced", gnuplotString(method.label));
      tracked += fmt::format("{}'{}' using 1:2 {}", column ? ", " : "", file, style);
      way += fmt::format("{}'{}' using 1:3 {}", column ? ", " : "", file, style);
      ++column;
    }
    std::stable_sort(t.rows.begin(), t.rows.end(),
                     [](const auto& a, const auto& b) { return a[0] < b[0]; });
    plot.script += tracked + '\n' + way + "\nunset multiplot\n";
    report.tables.push_back(t);
    report.plots.push_back(plot);
  }
  return report;
}

}  // namespace perception
