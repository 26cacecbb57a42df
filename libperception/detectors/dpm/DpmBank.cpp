#include "libperception/detectors/dpm/DpmBank.h"

#include <fmt/format.h>

#include <algorithm>

#include "libperception/core/Error.h"
#include "libperception/detectors/VisionSimd.h"

namespace perception {

DpmBank::DpmBank(std::vector<DpmTarget> t, DpmOptions o, SimdLevel level)
    : targets(std::move(t)), options(o), kernels(visionKernels(level)) {
  int largest = 1;
  for (const DpmTarget& target : targets) {
    cell = target.model.cell;
    if (cell != targets.front().model.cell)
      throw DataError(fmt::format("model {}: its cells have {} px, those of {} have {}",
                                  target.model.class_name, cell, targets.front().model.class_name,
                                  targets.front().model.cell));
    for (const DpmComponent& c : target.model.components) {
      for (const DpmPart& part : c.parts)
        largest = std::max({largest, part.filter.height, part.filter.width});
    }
  }
  valid = kPatch - largest + 1;
  if (valid < 4)
    throw DataError(
        fmt::format("a part of {} cells: at most {} are possible", largest, kPatch - 3));
  for (const DpmTarget& target : targets) addGroups(target);
}

void DpmBank::addGroups(const DpmTarget& target) {
  std::vector<Group> made;
  std::vector<Lane> lanes;
  const auto& components = target.model.components;
  for (std::size_t k = 0; k < components.size(); ++k) {
    for (std::size_t p = 0; p < components[k].parts.size(); ++p)
      lanes.push_back({static_cast<int>(k), static_cast<int>(p), 0});
  }
  const auto size = static_cast<std::size_t>(2 * kernels.lanes);
  for (std::size_t i = 0; i < lanes.size(); i += size) {
    const auto end = std::min(lanes.size(), i + size);
    made.push_back(makeGroup(target, {lanes.begin() + static_cast<std::ptrdiff_t>(i),
                                      lanes.begin() + static_cast<std::ptrdiff_t>(end)}));
  }
  groups.push_back(std::move(made));
}

DpmBank::Group DpmBank::makeGroup(const DpmTarget& target, const std::vector<Lane>& lanes) const {
  const int L = kernels.lanes, taps = 2 * options.window + 1;
  Group group;
  group.lanes = lanes;
  group.weights =
      AlignedFloats(static_cast<std::size_t>(kFrequencies * kHogFeatures * kWeights * L));
  group.costs_x = AlignedFloats(static_cast<std::size_t>(taps * 2 * L));
  group.costs_y = AlignedFloats(static_cast<std::size_t>(taps * 2 * L));
  std::fill_n(group.weights.data(), group.weights.size(), 0.F);
  std::fill_n(group.costs_x.data(), group.costs_x.size(), 0.F);
  std::fill_n(group.costs_y.data(), group.costs_y.size(), 0.F);
  constexpr std::size_t kCells = kPatch * kPatch;
  std::vector<float> patch(kCells * kHogFeatures), spectrum(kSpectrum);
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    const DpmPart& part = target.model.components[static_cast<std::size_t>(lanes[lane].component)]
                              .parts[static_cast<std::size_t>(lanes[lane].part)];
    const std::pair<int, int> parity{part.anchor_x & 1, part.anchor_y & 1};
    const auto known = std::find(group.parities.begin(), group.parities.end(), parity);
    group.lanes[lane].parity = static_cast<std::size_t>(known - group.parities.begin());
    if (known == group.parities.end()) group.parities.push_back(parity);
    std::fill(patch.begin(), patch.end(), 0.F);
    const int row = part.filter.width * kHogFeatures;
    for (int y = 0; y < part.filter.height; ++y)
      std::copy_n(part.filter.weights.begin() + y * row, row,
                  patch.begin() + y * kPatch * kHogFeatures);
    kernels.forward(patch.data(), kPatch * kHogFeatures, spectrum.data());
    const int i = static_cast<int>(lane), half = i / L;
    for (int w = 0; w < kFrequencies; ++w) {
      for (int f = 0; f < kHogFeatures; ++f) {
        float* to =
            group.weights.data() + ((w * kHogFeatures + f) * kWeights + half * 3) * L + i % L;
        const float* from = spectrum.data() + w * 3 * kHogFeatures + f;
        // Conjugate: a correlation; scaled for the inverse transform.
        const float re = from[0] / static_cast<float>(kCells);
        const float im = -from[kHogFeatures] / static_cast<float>(kCells);
        to[0] = re;
        to[L] = im - re;
        to[2 * L] = im + re;
      }
    }
    for (int t = 0; t < taps; ++t) {
      const double d = options.window - t;  // anchor - place
      const double* a = part.deformation;
      group.costs_x[static_cast<std::size_t>(t * 2 * L + i)] =
          static_cast<float>(a[0] * d * d + a[1] * d);
      group.costs_y[static_cast<std::size_t>(t * 2 * L + i)] =
          static_cast<float>(a[2] * d * d + a[3] * d);
    }
  }
  return group;
}

}  // namespace perception
