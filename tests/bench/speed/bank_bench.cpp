// Prediction of a four-state wheeled model by one scan; 20 scans in a row. Ours in batches against
// Eigen with fixed sizes and cv::KalmanFilter. Batches outer, methods inner, order rotated, CPU
// clock, results compared in the same run.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/filter/state/BankBatch.h"

namespace perception {
namespace {

using Vector2d = Eigen::Vector2d;
using Vector4d = Eigen::Vector4d;
using Matrix4d = Eigen::Matrix4d;

constexpr double kDt = 0.1, kAccel = 1.0, kYawRate = 0.0685, kSlip = 0.01;
constexpr std::size_t kFilters = 264;  // 66 objects of 4 classes: one bank
constexpr int kRounds = 60;
constexpr int kSteps = 20;  // a round: scans in a row, as a bank lives through them

double cpuNanoseconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

struct Case {
  Vector4d x;
  Matrix4d P;
};

std::vector<Case> cases() {
  Rng rng({1, 0, 0, 0});
  std::vector<Case> out(kFilters);
  for (Case& c : out) {
    c.x << rng.normal(0, 20), rng.normal(0, 20), rng.normal(5, 3), rng.uniform(-3, 3);
    c.P = Vector4d(0.3, 0.3, 1, 0.05).asDiagonal();
  }
  return out;
}

void jacobians(const Vector4d& x, Matrix4d& F, Matrix4d& Q) {
  const double c = std::cos(x[3]), s = std::sin(x[3]), v = x[2];
  F.setIdentity();
  F(0, 2) = kDt * c, F(0, 3) = -kDt * v * s, F(1, 2) = kDt * s, F(1, 3) = kDt * v * c;
  const Vector2d u(c, s), n(-v * s, v * c);
  Q.setZero();
  Q.topLeftCorner<2, 2>() =
      kDt * kDt * kDt / 3 * (kAccel * u * u.transpose() + kYawRate * n * n.transpose());
  Q(0, 0) += kSlip * kDt, Q(1, 1) += kSlip * kDt;
  Q.block<2, 1>(0, 2) = kDt * kDt / 2 * kAccel * u;
  Q.block<2, 1>(0, 3) = kDt * kDt / 2 * kYawRate * n;
  Q.block<1, 2>(2, 0) = Q.block<2, 1>(0, 2).transpose();
  Q.block<1, 2>(3, 0) = Q.block<2, 1>(0, 3).transpose();
  Q(2, 2) = kAccel * kDt, Q(3, 3) = kYawRate * kDt;
}

struct Result {
  std::vector<Vector4d> x;
};

double stepEigen(const std::vector<Case>& cs, Result& out) {
  std::vector<Matrix4d> covariance;
  for (std::size_t i = 0; i < cs.size(); ++i) {
    out.x[i] = cs[i].x;
    covariance.push_back(cs[i].P);
  }
  const double begin = cpuNanoseconds();
  for (int k = 0; k < kSteps; ++k) {
    for (std::size_t i = 0; i < cs.size(); ++i) {
      Matrix4d F, Q;
      Vector4d x = out.x[i];
      jacobians(x, F, Q);
      x.head<2>() += x[2] * F.block<2, 1>(0, 2);
      out.x[i] = x;
      covariance[i] = F * covariance[i] * F.transpose() + Q;
    }
  }
  return (cpuNanoseconds() - begin) / kSteps;
}

/// A bank as a structure of arrays.
struct OurBank {
  explicit OurBank(const std::vector<Case>& cs) : bank(cs.size()), motion(cs.size()) {
    for (std::size_t i = 0; i < cs.size(); ++i) {
      std::size_t plane = 4;
      for (int r = 0; r < 4; ++r) {
        bank[static_cast<std::size_t>(r)][i] = cs[i].x[r];
        for (int c = r; c < 4; ++c) bank[plane++][i] = cs[i].P(r, c);
      }
      motion[MotionBatch::kDecay][i] = 1, motion[MotionBatch::kEffectiveDt][i] = kDt;
      motion[MotionBatch::kPp][i] = kAccel * kDt * kDt * kDt / 3;
      motion[MotionBatch::kPv][i] = kAccel * kDt * kDt / 2;
      motion[MotionBatch::kVv][i] = kAccel * kDt;
      motion[MotionBatch::kSlip][i] = kSlip * kDt;
      motion[MotionBatch::kYawPp][i] = kYawRate * kDt * kDt * kDt / 3;
      motion[MotionBatch::kYawPy][i] = kYawRate * kDt * kDt / 2;
      motion[MotionBatch::kYawYy][i] = kYawRate * kDt;
    }
  }

  void step(SimdLevel level) {
    for (std::size_t first = 0; first < bank.size(); first += BatchPart::kPart) {
      const BatchPart part{first, std::min(first + BatchPart::kPart, bank.size())};
      predictWheeled(motion, bank, level, part);
    }
  }

  BankBatch bank;
  MotionBatch motion;
};

double stepOurs(const std::vector<Case>& cs, SimdLevel level, Result& out) {
  OurBank ours(cs);
  // A bank lives as a structure of arrays: filling it is not part of a step.
  const double begin = cpuNanoseconds();
  for (int k = 0; k < kSteps; ++k) ours.step(level);
  const double time = (cpuNanoseconds() - begin) / kSteps;
  for (std::size_t i = 0; i < cs.size(); ++i) {
    for (std::size_t r = 0; r < 4; ++r) out.x[i][static_cast<Eigen::Index>(r)] = ours.bank[r][i];
  }
  return time;
}

void stepOne(cv::KalmanFilter& f) {
  Vector4d x;
  for (int r = 0; r < 4; ++r) x[r] = f.statePost.at<double>(r);
  Matrix4d F, Q;
  jacobians(x, F, Q);
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      f.transitionMatrix.at<double>(r, c) = F(r, c);
      f.processNoiseCov.at<double>(r, c) = Q(r, c);
    }
  }
  f.predict();
  // The linear prediction F x is not the model's mean: as its users do, the mean is set.
  f.statePost.at<double>(0) = x[0] + x[2] * F(0, 2);
  f.statePost.at<double>(1) = x[1] + x[2] * F(1, 2);
  f.statePost.at<double>(3) = x[3];
}

double stepOpenCv(const std::vector<Case>& cs, Result& out) {
  std::vector<cv::KalmanFilter> filters;
  for (const Case& c : cs) {
    cv::KalmanFilter f(4, 2, 0, CV_64F);
    for (int i = 0; i < 4; ++i) {
      f.statePost.at<double>(i) = c.x[i];
      for (int j = 0; j < 4; ++j) f.errorCovPost.at<double>(i, j) = c.P(i, j);
    }
    filters.push_back(f);
  }
  const double begin = cpuNanoseconds();
  for (int k = 0; k < kSteps; ++k)
    for (auto& f : filters) stepOne(f);
  const double time = (cpuNanoseconds() - begin) / kSteps;
  for (std::size_t i = 0; i < cs.size(); ++i)
    for (int r = 0; r < 4; ++r) out.x[i][r] = filters[i].statePost.at<double>(r);
  return time;
}

double quantile(std::vector<double> v, double q) {
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
}

double stateError(const Result& a, const Result& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    Vector4d d = a.x[i] - b.x[i];
    d[3] = wrapAngle(d[3]);
    worst = std::max(worst, d.cwiseAbs().maxCoeff());
  }
  return worst;
}

int main() {
  const auto cs = cases();
  const Result empty{std::vector<Vector4d>(kFilters, Vector4d::Zero())};
  Result ours = empty, eigen = empty, opencv = empty, other = empty;
  std::vector<double> t_ours, t_eigen, t_opencv;
  for (int round = 0; round < kRounds; ++round) {
    for (int k = 0; k < 3; ++k) {
      switch ((k + round) % 3) {
        case 0:
          t_ours.push_back(stepOurs(cs, simdLevel(), ours));
          break;
        case 1:
          t_eigen.push_back(stepEigen(cs, eigen));
          break;
        default:
          t_opencv.push_back(stepOpenCv(cs, opencv));
      }
    }
  }
  fmt::print("{} filters a batch, {} rounds, {} (widest here)\n", kFilters, kRounds,
             nameOf(simdLevel()));
  const auto row = [&](const char* name, const std::vector<double>& t) {
    std::vector<double> ratio;
    for (std::size_t i = 0; i < t.size(); ++i) ratio.push_back(t[i] / t_ours[i]);
    fmt::print(
        "{:<22} {:>8.1f} ns p50 {:>8.1f} ns p99   ratio to ours: p50 {:>6.1f}  p99 {:>6.1f}\n",
        name, quantile(t, 0.5) / kFilters, quantile(t, 0.99) / kFilters, quantile(ratio, 0.5),
        quantile(ratio, 0.99));
  };
  row("ours", t_ours);
  row("Eigen, fixed size", t_eigen);
  row("cv::KalmanFilter", t_opencv);
  for (const SimdLevel level : {SimdLevel::kSse2, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (level > simdLevel()) continue;
    std::vector<double> t, r;
    for (int round = 0; round < 30; ++round) {
      t.push_back(stepOurs(cs, level, other));
      r.push_back(stepEigen(cs, eigen) / t.back());
    }
    fmt::print("ours at {:<7} {:>8.1f} ns p50; Eigen {:.1f} x\n", nameOf(level),
               quantile(t, 0.5) / kFilters, quantile(r, 0.5));
  }
  fmt::print("largest difference of a state: Eigen {:.1e}, OpenCV {:.1e}\n",
             stateError(ours, eigen), stateError(ours, opencv));
  const bool same = stateError(ours, eigen) < 1e-6 && stateError(ours, opencv) < 1e-6;
  fmt::print("{}\n", same ? "same answers" : "ANSWERS DIFFER");
  return same ? 0 : 1;
}

}  // namespace
}  // namespace perception

int main() { return perception::main(); }
