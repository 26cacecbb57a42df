// How well weather/trust/PointTrust and the filters that it is compared with tell falling snow from
// surfaces, on labeled scans: WADS sequence 36 (real snow) and SnowyKITTI (simulated snow on real
// scans). Parameters come from WADS's odd scans, figures from its even ones.
//   trust_study           the tables
//   trust_study fit       fits the curves of [weather.trust] to the odd scans and prints them
#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>

#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/weather/trust/PointTrust.h"
#include "tests/bench/quality/SnowFilters.h"
#include "tests/support/LabeledScans.h"

namespace perception {
namespace {

using test::LabeledScan;
using test::PhantomScore;

const std::string kData = std::string(PERCEPTION_SHARED_DATA) + "/data";
double kRoadUserCost = 4;  // a lost return of a car or person weighs as much as four

std::vector<LabeledScan> wads() { return test::labeledScans(kData + "/wads_snow", 2.17); }
std::vector<LabeledScan> snowyKitti() { return test::labeledScans(kData + "/snowykitti", 1.73); }

void measureGround(std::vector<LabeledScan>& scans) {
  GroundEstimator ground;
  for (LabeledScan& scan : scans) scan.frame.ground = ground.update(scan.frame);
}

bool isOdd(const LabeledScan& scan) { return scan.number % 2 == 1; }

// ----------------------------------------------------------------------------------------------
// fit

/// Logistic regression with a small ridge, by Newton's method, one sample at a time.
class Logistic {
 public:
  explicit Logistic(Eigen::Index size) : weights_(Eigen::VectorXd::Zero(size)) {}
  struct Sample {
    std::vector<float> x;
    bool phantom;
    float weight;
  };
  void fit(const std::vector<Sample>& samples) {
    const Eigen::Index size = weights_.size();
    for (int step = 0; step < 15; ++step) {
      Eigen::MatrixXd H = 1.0 * Eigen::MatrixXd::Identity(size, size);
      Eigen::VectorXd g = -1.0 * weights_, x(size);
      for (const Sample& s : samples) {
        for (Eigen::Index k = 0; k < size; ++k)
          x[k] = static_cast<double>(s.x[static_cast<std::size_t>(k)]);
        const double p = 1 / (1 + std::exp(-std::clamp(weights_.dot(x), -30.0, 30.0)));
        const auto w = static_cast<double>(s.weight);
        g += w * ((s.phantom ? 1 : 0) - p) * x;
        H.selfadjointView<Eigen::Lower>().rankUpdate(x, w * std::max(1e-6, p * (1 - p)));
      }
      weights_ += H.selfadjointView<Eigen::Lower>().ldlt().solve(g);
    }
  }
  double operator[](Eigen::Index k) const { return weights_[k]; }

 private:
  Eigen::VectorXd weights_;
};

/// Hat functions of the features, at all knots but the first, whose value is 0 (the bias takes it).
class Basis {
 public:
  explicit Basis(std::vector<TrustFeature> features) : features_(std::move(features)) {
    for (const TrustFeature feature : features_) {
      const auto& knots = TrustParams::knotsOf(feature);
      for (std::size_t k = 1; k < knots.size(); ++k) {
        std::vector<double> unit(knots.size(), 0);
        unit[k] = 1;
        hats_.push_back({feature, TrustCurve(knots, unit)});
      }
    }
  }
  std::size_t size() const { return hats_.size(); }
  void append(const SuspectReturn& s, std::vector<float>& x) const {
    for (const auto& [feature, hat] : hats_)
      x.push_back(hat.at(s.features[static_cast<std::size_t>(feature)]));
  }
  void store(const Logistic& fitted, Eigen::Index first, TrustParams& params) const {
    for (const TrustFeature feature : features_) {
      auto& curve = params.curves[static_cast<std::size_t>(feature)];
      curve.assign(TrustParams::knotsOf(feature).size(), 0);
      for (std::size_t k = 1; k < curve.size(); ++k) curve[k] = fitted[first++];
    }
  }

 private:
  std::vector<TrustFeature> features_;
  std::vector<std::pair<TrustFeature, TrustCurve>> hats_;
};

float costOf(std::uint32_t label) {
  return test::isRoadUser(label) ? static_cast<float>(kRoadUserCost) : 1.0F;
}

/// Runs the model over all scans; `look` sees what it made of each odd one.
void overOddScans(std::vector<LabeledScan>& scans, const TrustParams& params,
                  const std::function<void(const LabeledScan&, const PointTrust&)>& look) {
  PointTrust trust(params);
  for (LabeledScan& scan : scans) {
    trust.apply(scan.frame);
    if (isOdd(scan)) look(scan, trust);
  }
}

TrustParams fitted(std::vector<LabeledScan>& scans) {
  TrustParams params;
  params.adapt_share = false;
  std::size_t phantoms = 0, near = 0;
  for (const LabeledScan& scan : scans) {
    if (!isOdd(scan)) continue;
    const auto& cloud = std::get<LidarCloud>(scan.frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double r = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
      if (r > params.share_range) continue;
      ++near, phantoms += scan.labels[i] == test::kSnowLabel;
    }
  }
  params.fitted_share = static_cast<double>(phantoms) / static_cast<double>(near);

  const Basis first({TrustFeature::kRange, TrustFeature::kTight, TrustFeature::kWide,
                     TrustFeature::kBeyond, TrustFeature::kHeight});
  std::vector<Logistic::Sample> samples;
  overOddScans(scans, params, [&](const LabeledScan& scan, const PointTrust& trust) {
    for (const SuspectReturn& s : trust.suspects()) {
      const std::uint32_t label = scan.labels[s.index];
      if (label == test::kUnlabeled) continue;
      Logistic::Sample& sample = samples.emplace_back();
      sample.x = {1};
      first.append(s, sample.x);
      sample.phantom = label == test::kSnowLabel, sample.weight = costOf(label);
    }
  });
  Logistic geometry(static_cast<Eigen::Index>(first.size() + 1));
  geometry.fit(samples);
  params.bias = geometry[0];
  first.store(geometry, 1, params);

  const Basis second({TrustFeature::kSurroundings});
  samples.clear();
  for (const bool intensity : {true, false}) {
    params.use_intensity = intensity;
    overOddScans(scans, params, [&](const LabeledScan& scan, const PointTrust& trust) {
      for (const SuspectReturn& s : trust.suspects()) {
        const std::uint32_t label = scan.labels[s.index];
        if (label == test::kUnlabeled || s.first < -5) continue;
        Logistic::Sample& sample = samples.emplace_back();
        sample.x = {1, s.first};
        second.append(s, sample.x);
        sample.phantom = label == test::kSnowLabel, sample.weight = costOf(label);
      }
    });
  }
  Logistic neighbors(static_cast<Eigen::Index>(second.size() + 2));
  neighbors.fit(samples);
  params.second_bias = neighbors[0];
  params.gain = neighbors[1];
  second.store(neighbors, 2, params);
  params.use_intensity = params.adapt_share = true;
  return params;
}

void printParams(const TrustParams& p) {
  const char* names[kTrustFeatures] = {"kRange",  "kTight",  "kWide",
                                       "kBeyond", "kHeight", "kSurroundings"};
  for (std::size_t f = 0; f < kTrustFeatures; ++f) {
    std::string line;
    for (const double v : p.curves[f]) line += fmt::format("{}{:.2f}", line.empty() ? "" : ", ", v);
    fmt::print("{} {{{}}}\n", names[f], line);
  }
  fmt::print("bias {:.2f} gain {:.2f} second_bias {:.2f} fitted_share {:.4f}\n", p.bias, p.gain,
             p.second_bias, p.fitted_share);
}

// -------------------------------------------------------------------------------------------
// tables

struct Candidate {
  std::string name;
  std::unique_ptr<PointFilter> filter;
  bool hide_intensity = false;
};

std::vector<Candidate> candidates(const TrustParams& trust) {
  std::vector<Candidate> all;
  const auto add = [&](const std::string& name, std::unique_ptr<PointFilter> filter,
                       bool hide_intensity = false) {
    all.push_back({name, std::move(filter), hide_intensity});
  };
  TrustParams fixed_share = trust;
  fixed_share.adapt_share = false;
  bench::DrorParams dark_and_near;
  dark_and_near.max_intensity = 0, dark_and_near.max_range = 20;
  add("trust", makePointTrust(trust));
  add("trust, intensity hidden", makePointTrust(trust), true);
  add("trust, share not adapted", makePointTrust(fixed_share));
  add("DSOR", bench::makeDsor({}));
  add("DROR", bench::makeDror({}));
  add("DROR of zero intensity within 20 m", bench::makeDror(dark_and_near));
  add("LIOR", bench::makeLior({}));
  return all;
}

void score(std::vector<LabeledScan>& scans, const Candidate& candidate, std::uint32_t phantom,
           bool even_only) {
  PhantomScore known, all;
  double share = 0;
  for (LabeledScan& scan : scans) {
    SensorFrame frame = scan.frame;
    auto& cloud = std::get<LidarCloud>(frame.data);
    if (candidate.hide_intensity) cloud.intensity.clear();
    share = candidate.filter->apply(frame).share;
    if (even_only && isOdd(scan)) continue;
    known.add(scan, cloud.trust, phantom);
    all.add(scan, cloud.trust, phantom, true);
  }
  fmt::print("| {} | {:.4f} | {:.4f} | {:.4f} | {:.2f} % | {:.4f} | {:.3f} |\n", candidate.name,
             known.f1(), known.precision(), known.recall(), 100 * known.lost(), all.f1(), share);
  std::fflush(stdout);
}

/// Are the probabilities right? Of the even scans' labeled returns.
void calibration(std::vector<LabeledScan>& scans, const TrustParams& params) {
  PointTrust trust(params);
  std::vector<std::size_t> count(10, 0), snow(10, 0);
  std::vector<double> sum(10, 0);
  for (LabeledScan& scan : scans) {
    trust.apply(scan.frame);
    if (isOdd(scan)) continue;
    const auto& cloud = std::get<LidarCloud>(scan.frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (scan.labels[i] == test::kUnlabeled) continue;
      const double p = 1 - static_cast<double>(cloud.trust[i]);
      const auto bin = std::min<std::size_t>(9, static_cast<std::size_t>(p * 10));
      ++count[bin], sum[bin] += p, snow[bin] += scan.labels[i] == test::kSnowLabel;
    }
  }
  fmt::print("\n| P(phantom) said | returns | share of falling snow |\n|---|---|---|\n");
  for (std::size_t b = 0; b < 10; ++b)
    fmt::print("| {:.3f} | {} | {:.3f} |\n", sum[b] / std::max<double>(1, double(count[b])),
               count[b], double(snow[b]) / std::max<double>(1, double(count[b])));
}

void lostByClass(std::vector<LabeledScan>& scans, const TrustParams& params) {
  PointTrust trust(params);
  std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> lost;
  for (LabeledScan& scan : scans) {
    trust.apply(scan.frame);
    if (isOdd(scan)) continue;
    const auto& cloud = std::get<LidarCloud>(scan.frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      auto& [all, doubted] = lost[scan.labels[i]];
      ++all, doubted += cloud.trust[i] < 0.5F;
    }
  }
  fmt::print("\n| class | returns | doubted |\n|---|---|---|\n");
  for (const auto& [label, counts] : lost)
    fmt::print("| {} | {} | {:.3f} % |\n", label, counts.first,
               100.0 * double(counts.second) / double(counts.first));
  fmt::print("\nlearnt log-ratios of intensity:");
  for (const float ratio : trust.intensityLogRatios()) fmt::print(" {:.2f}", ratio);
  fmt::print("\nrow of the range image {:.2f} deg\n", degrees(trust.rowPitch()));
}

void tables(std::vector<LabeledScan>& scans, const TrustParams& params) {
  const char* head =
      "| filter | F1 | precision | recall | car and person lost | F1, unlabeled as surface | "
      "share "
      "|\n|---|---|---|---|---|---|---|\n";
  fmt::print("WADS 36, even scans, real falling snow\n\n{}", head);
  for (const Candidate& c : candidates(params)) score(scans, c, test::kSnowLabel, true);
  calibration(scans, params);
  lostByClass(scans, params);
  auto kitti = snowyKitti();
  measureGround(kitti);
  fmt::print("\nSnowyKITTI, simulated snow, the same parameters\n\n{}", head);
  for (const Candidate& c : candidates(params)) score(kitti, c, 1, false);
}

/// Dry roads: nothing should be doubted. KITTI 0000, every fifth scan.
void clearAir(const TrustParams& params) {
  auto scans = test::labeledScans(kData + "/kitti_lidar_seq0000", 1.73, 1000, "velodyne_full");
  measureGround(scans);
  fmt::print(
      "\nKITTI 0000, clear air, {} scans\n\n| filter | doubted | of the returns within 30 m and .3 "
      "to "
      "3 m above ground | share |\n|---|---|---|---|\n",
      scans.size());
  for (const Candidate& candidate : candidates(params)) {
    std::size_t all = 0, doubted = 0, obstacles = 0, doubted_obstacles = 0;
    double share = 0;
    for (LabeledScan& scan : scans) {
      SensorFrame frame = scan.frame;
      auto& cloud = std::get<LidarCloud>(frame.data);
      if (candidate.hide_intensity) cloud.intensity.clear();
      share = candidate.filter->apply(frame).share;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const float above = cloud.z[i] + 1.73F;
        const bool obstacle = std::hypot(cloud.x[i], cloud.y[i]) < 30 && above > 0.3F && above < 3;
        const bool doubts = cloud.trust[i] < 0.5F;
        ++all, doubted += doubts, obstacles += obstacle, doubted_obstacles += obstacle && doubts;
      }
    }
    fmt::print("| {} | {:.4f} % | {:.4f} % | {:.4f} |\n", candidate.name,
               100.0 * double(doubted) / double(all),
               100.0 * double(doubted_obstacles) / double(obstacles), share);
    std::fflush(stdout);
  }
}

int run(bool fit) {
  auto scans = wads();
  if (scans.empty()) {
    fmt::print("no recordings in {}\n", kData);
    return 0;
  }
  measureGround(scans);
  TrustParams params;
  if (fit) {
    params = fitted(scans);
    printParams(params);
  }
  tables(scans, params);
  clearAir(params);
  return 0;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  if (argc > 2) perception::kRoadUserCost = std::atof(argv[2]);
  return perception::run(argc > 1 && std::strcmp(argv[1], "fit") == 0);
}
