// Resampling 512 particles of 66 objects, and what a particle takes in memory: a particle as a
// handle of a hypothesis (the filter's), as 66 handles of tracks, and as 66 tracks of its own.
// Methods inner, order rotated, CPU clock; all three hold the same objects afterwards.
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/filter/state/Track.h"
#include "tests/bench/speed/CpuClock.h"

namespace perception {
namespace {

constexpr std::size_t kParticles = 512, kObjects = 66, kClasses = 5;
constexpr std::size_t kDistinct = 240;  // tracks of 1000 ranked hypotheses: filter_load_bench
constexpr int kRounds = 200;

TrackTable tracks() {
  TrackTable out;
  for (std::size_t i = 0; i < kDistinct; ++i) {
    Track t;
    t.id = t.history = i + 1;
    t.bank.resize(kClasses);
    t.log_class.assign(kClasses, -1.6);
    out.push_back(std::make_shared<const Track>(std::move(t)));
  }
  return out;
}

/// By particle: which track stands for each object.
std::vector<std::vector<std::uint32_t>> choices(Rng& rng) {
  std::vector<std::vector<std::uint32_t>> out(kParticles);
  for (auto& c : out) {
    for (std::uint32_t o = 0; o < kObjects; ++o) {
      const bool ambiguous = o + kObjects < kDistinct && rng.uniform() < 0.3;
      c.push_back(ambiguous ? o + static_cast<std::uint32_t>(kObjects) : o);
    }
  }
  return out;
}

/// Systematic resampling of weights that make two thirds of the particles die.
std::vector<std::size_t> survivors(Rng& rng) {
  std::vector<double> weights(kParticles);
  double total = 0;
  for (double& w : weights) total += w = rng.exponential(1) * rng.exponential(1);
  std::vector<std::size_t> out;
  double sum = 0;
  const double start = rng.uniform();
  for (std::size_t i = 0; i < kParticles; ++i) {
    sum += weights[i] / total * static_cast<double>(kParticles);
    while (static_cast<double>(out.size()) + start < sum && out.size() < kParticles)
      out.push_back(i);
  }
  while (out.size() < kParticles) out.push_back(kParticles - 1);
  return out;
}

/// MRPT's way: the chosen ones into a new list that takes the old one's place.
template <class Particle>
void resample(const std::vector<std::size_t>& indices, std::vector<Particle>& particles) {
  std::vector<Particle> next;
  next.reserve(indices.size());
  for (const std::size_t i : indices) next.push_back(particles[i]);
  particles = std::move(next);
}

double heapBytes() { return static_cast<double>(mallinfo2().uordblks); }

template <class Particle, class Make>
std::vector<Particle> made(const Make& make, double& bytes_each) {
  const double before = heapBytes();
  std::vector<Particle> out;
  out.reserve(kParticles);
  for (std::size_t p = 0; p < kParticles; ++p) out.push_back(make(p));
  bytes_each = (heapBytes() - before) / kParticles;
  return out;
}

std::uint64_t sumOfHistories(const HypothesisHandle& h) {
  std::uint64_t sum = 0;
  for (const auto& t : h->tracks) sum += t->history;
  return sum;
}
std::uint64_t sumOfHistories(const std::vector<TrackHandle>& h) {
  std::uint64_t sum = 0;
  for (const auto& t : h) sum += t->history;
  return sum;
}
std::uint64_t sumOfHistories(const std::vector<Track>& h) {
  std::uint64_t sum = 0;
  for (const auto& t : h) sum += t.history;
  return sum;
}

}  // namespace
}  // namespace perception

int main() {
  using namespace perception;
  Rng rng({4, 0, 0, 0});
  const auto table = std::make_shared<const TrackTable>(tracks());
  const auto chosen = choices(rng);
  std::array<double, 3> bytes{};
  auto hypotheses = made<HypothesisHandle>(
      [&](std::size_t p) {
        return std::make_shared<const Hypothesis>(TrackList(table, chosen[p]), p);
      },
      bytes[0]);
  auto handles = made<std::vector<TrackHandle>>(
      [&](std::size_t p) {
        std::vector<TrackHandle> own;
        own.reserve(kObjects);
        for (const auto i : chosen[p]) own.push_back((*table)[i]);
        return own;
      },
      bytes[1]);
  auto copies = made<std::vector<Track>>(
      [&](std::size_t p) {
        std::vector<Track> own;
        own.reserve(kObjects);
        for (const auto i : chosen[p]) own.push_back(*(*table)[i]);
        return own;
      },
      bytes[2]);

  std::array<std::vector<double>, 3> micros;
  bool same = true;
  for (int round = 0; round < kRounds; ++round) {
    const auto indices = survivors(rng);
    for (int m = 0; m < 3; ++m) {
      const int method = (m + round) % 3;
      const double begin = test::cpuSeconds();
      if (method == 0) resample(indices, hypotheses);
      if (method == 1) resample(indices, handles);
      if (method == 2) resample(indices, copies);
      micros[static_cast<std::size_t>(method)].push_back(1e6 * (test::cpuSeconds() - begin));
    }
    for (std::size_t p = 0; p < kParticles; ++p) {
      const std::uint64_t sum = sumOfHistories(hypotheses[p]);
      same = same && sum == sumOfHistories(handles[p]) && sum == sumOfHistories(copies[p]);
    }
  }
  fmt::print("{} particles of {} objects, {} classes, {} distinct tracks, {} rounds\n", kParticles,
             kObjects, kClasses, kDistinct, kRounds);
  const char* names[3] = {"handle of a hypothesis", "66 handles of tracks", "66 tracks of its own"};
  std::vector<double> ours = micros[0];
  std::nth_element(ours.begin(), ours.begin() + kRounds / 2, ours.end());
  for (std::size_t m = 0; m < 3; ++m) {
    auto& t = micros[m];
    std::sort(t.begin(), t.end());
    fmt::print(
        "{:<24} {:>9.1f} us p50 {:>9.1f} us p99   {:>7.1f} x ours {:>10.0f} bytes a particle\n",
        names[m], t[kRounds / 2], t[kRounds * 99 / 100], t[kRounds / 2] / ours[kRounds / 2],
        bytes[m]);
  }
  fmt::print("{}\n", same ? "same objects" : "OBJECTS DIFFER");
  return same ? 0 : 1;
}
