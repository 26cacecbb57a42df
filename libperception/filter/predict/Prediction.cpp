#include "libperception/filter/predict/Prediction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/filter/state/BankBatch.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

/// A track that no sensor could have seen for this long counts as out of view.
constexpr double kOutOfViewAfter = 1.0;  // [s]
/// Smallest number of Gaussians for a batch.
constexpr std::size_t kWorthBatch = 8;

/// Tracks that are begun one after the other.
constexpr std::size_t kChunk = 16;

/// The class chain over one step (method.md 5.7). Most tracks take the same step.
struct ClassChain {
  double dt = -1, time_constant = 0;  // [s]
  int classes = 0;
  double keep = 1, uniform = 0;

  static const ClassChain& over(double dt, const FilterModel& model) {
    thread_local ClassChain last;
    const double time_constant = model.params.class_forgetting;
    const int classes = model.classes.size();
    if (last.dt != dt || last.time_constant != time_constant || last.classes != classes) {
      const double forget = -std::expm1(-dt / time_constant);
      last = {dt, time_constant, classes, 1 - forget, forget / static_cast<double>(classes)};
    }
    return last;
  }
};

/// Existence and classes of `track` at a later time, in place.
void moveOdds(const Track& track, Stamp to, const FilterModel& model, double& existence,
              std::vector<double>& log_class) {
  const double dt = to - track.stamp;
  if (dt <= 0) return;
  existence = predictExistence(track, to, model);
  const ClassChain& chain = ClassChain::over(dt, model);
  for (double& lp : log_class) lp = std::log(chain.keep * std::exp(lp) + chain.uniform);
}

/// All of the prediction but the motion of the Gaussians, which go to `steps`.
void beginTrack(Stamp to, const FilterModel& model, Track& next, std::vector<GaussianStep>& steps) {
  const double dt = to - next.stamp;
  if (dt <= 0) return;
  moveOdds(next, to, model, next.existence, next.log_class);
  next.stamp = to;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    if (next.live(j))
      listSteps(model.classes[j], dt, next.bank[static_cast<std::size_t>(j)], steps);
  }
  next.base_z.variance += model.params.base_walk * dt;
  if (next.body_heading) next.body_heading->variance += model.params.body_heading_walk * dt;
}

/// Coefficients of a Gaussian's F and Q (method.md (4) and (7)), as planes of a MotionBatch.
void putMotion(const GaussianStep& s, const SpeedNoise& n, std::size_t i, MotionBatch& motion) {
  motion[MotionBatch::kDecay][i] = n.decay;
  motion[MotionBatch::kEffectiveDt][i] = n.effective_dt;
  motion[MotionBatch::kPp][i] = s.psd * n.pp;
  motion[MotionBatch::kPv][i] = s.psd * n.pv;
  motion[MotionBatch::kVv][i] = s.psd * n.vv;
  motion[MotionBatch::kSlip][i] = s.object_class->position_psd * s.dt;
  const double qw = s.object_class->yawRatePsd((*s.x)[2]);
  motion[MotionBatch::kYawPp][i] = qw * s.dt * s.dt * s.dt / 3;
  motion[MotionBatch::kYawPy][i] = qw * s.dt * s.dt / 2;
  motion[MotionBatch::kYawYy][i] = qw * s.dt;
}

void putGaussian(const GaussianStep& s, std::size_t i, BankBatch& bank) {
  std::size_t plane = 0;
  for (int r = 0; r < 4; ++r) bank[plane++][i] = (*s.x)[r];
  for (int r = 0; r < 4; ++r)
    for (int c = r; c < 4; ++c) bank[plane++][i] = (*s.P)(r, c);
}

void takeGaussian(const BankBatch& bank, std::size_t i, const GaussianStep& s) {
  std::size_t plane = 0;
  for (int r = 0; r < 4; ++r) (*s.x)[r] = bank[plane++][i];
  for (int r = 0; r < 4; ++r)
    for (int c = r; c < 4; ++c) (*s.P)(r, c) = (*s.P)(c, r) = bank[plane++][i];
}

using Kernel = void (*)(const MotionBatch&, BankBatch&, SimdLevel, BatchPart);
constexpr std::pair<BatchKernel, Kernel> kKernels[] = {
    {BatchKernel::kConstantVelocity, predictConstantVelocity},
    {BatchKernel::kWheeled, predictWheeled},
    {BatchKernel::kMoments, predictMoments}};
using KernelSteps = std::array<std::vector<GaussianStep>, std::size(kKernels) + 1>;  // by kernel

BatchKernel kernelOf(const GaussianStep& s) {
  const auto kernel = s.object_class->motion->kernel;
  return kernel ? kernel(s) : BatchKernel::kNone;
}

void moveBatch(const std::vector<GaussianStep>& steps, Kernel kernel) {
  if (steps.size() < kWorthBatch) {
    for (const auto& s : steps) predictGaussian(s);
    return;
  }
  const std::size_t parts = (steps.size() + BatchPart::kPart - 1) / BatchPart::kPart;
  parallelFor(parts, [&](std::size_t p) {
    // One buffer per thread, sized for the cache; old contents are overwritten.
    thread_local BankBatch bank(BatchPart::kPart);
    thread_local MotionBatch motion(BatchPart::kPart);
    const std::size_t first = p * BatchPart::kPart;
    const std::size_t count = std::min(BatchPart::kPart, steps.size() - first);
    const GaussianStep* own = &steps[first];
    SpeedNoise noise(own->damping, own->dt);
    for (std::size_t i = 0; i < count; ++i) {
      // Most take the same step.
      if (i > 0 && (own[i].dt != own[i - 1].dt || own[i].damping != own[i - 1].damping))
        noise = SpeedNoise(own[i].damping, own[i].dt);
      putMotion(own[i], noise, i, motion);
      putGaussian(own[i], i, bank);
    }
    kernel(motion, bank, simdLevel(), {0, count});
    for (std::size_t i = 0; i < count; ++i) takeGaussian(bank, i, own[i]);
  });
}

}  // namespace

double predictExistence(const Track& track, Stamp to, const FilterModel& model) {
  const double dt = to - track.stamp;
  if (dt <= 0) return track.existence;
  const auto& p = model.params;
  const double until = track.last_in_view - track.stamp + kOutOfViewAfter;
  const double in_view = std::clamp(until, 0.0, dt);
  const double lives = in_view / p.survival_in_view + (dt - in_view) / p.survival_out_of_view;
  const double decay = p.existence_decay;  // to 5 % = e^-3 in this time
  return track.existence * std::exp(decay > 0 ? -3 * dt / decay : -lives);
}

TrackOdds predictOdds(const Track& track, Stamp to, const FilterModel& model) {
  TrackOdds odds{track.existence, track.log_class};
  moveOdds(track, to, model, odds.existence, odds.log_class);
  return odds;
}

double timeToLive(const Track& track, const FilterModel& model) {
  const auto& p = model.params;
  if (track.existence <= p.existence_min) return 0;
  const double lives = std::log(track.existence / p.existence_min);
  if (p.existence_decay > 0) return lives * p.existence_decay / 3;
  const double in_view = std::max(track.last_in_view - track.stamp + kOutOfViewAfter, 0.0);
  const double rest = lives - in_view / p.survival_in_view;
  return rest > 0 ? in_view + rest * p.survival_out_of_view : lives * p.survival_in_view;
}

double longestLife(const FilterParams& p) {
  const double lives = -std::log(p.existence_min);
  if (p.existence_decay > 0) return lives * p.existence_decay / 3;
  return kOutOfViewAfter + lives * p.survival_out_of_view;
}

Track predictTrack(const Track& track, Stamp to, const FilterModel& model) {
  Track next = track;
  std::vector<GaussianStep> steps;
  beginTrack(to, model, next, steps);
  for (const auto& s : steps) predictGaussian(s);
  for (auto& f : next.bank) combineModes(f);
  return next;
}

std::vector<Track> predictTracks(const std::vector<TrackHandle>& tracks,
                                 const std::vector<char>& touched, Stamp to,
                                 const FilterModel& model) {
  std::vector<Track> predicted(tracks.size());
  std::vector<KernelSteps> steps((tracks.size() + kChunk - 1) / kChunk);
  parallelFor(steps.size(), [&](std::size_t chunk) {
    std::vector<GaussianStep> own;
    own.reserve(kChunk * static_cast<std::size_t>(model.classes.size()));
    const std::size_t end = std::min((chunk + 1) * kChunk, tracks.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      if (!touched[i]) continue;
      predicted[i] = *tracks[i];
      beginTrack(to, model, predicted[i], own);
    }
    for (const auto& s : own) {
      const BatchKernel kernel = kernelOf(s);
      if (kernel == BatchKernel::kNone) {
        predictGaussian(s);
      } else {
        steps[chunk][static_cast<std::size_t>(kernel)].push_back(s);
      }
    }
  });
  for (const auto& [kernel, move] : kKernels) {
    std::vector<GaussianStep> all;
    for (const auto& chunk : steps) {
      const auto& own = chunk[static_cast<std::size_t>(kernel)];
      all.insert(all.end(), own.begin(), own.end());
    }
    moveBatch(all, move);
  }
  const auto& classes = model.classes.classes;
  if (model.params.fast_births <= 0 &&
      std::none_of(classes.begin(), classes.end(), [](const auto& c) { return c.modes() > 0; }))
    return predicted;
  parallelFor(tracks.size(), [&](std::size_t i) {
    if (!touched[i]) return;
    for (auto& f : predicted[i].bank) combineModes(f);
  });
  return predicted;
}

}  // namespace perception
