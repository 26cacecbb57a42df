#include "studies/gps/GpsStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "libperception/sensors/satellites/PositionTrack.h"
#include "studies/gps/GpsNoise.h"

namespace perception {
namespace {

constexpr std::uint32_t kPurpose = 0x5730;
constexpr std::size_t kTrainingSections = 60;  // a class, for the process noises
constexpr double kMaxBias = 12;                // log likelihood
constexpr std::size_t kGpsModes = 4;

std::string userOf(const std::string& stem) {
  const auto first = stem.find('_');
  if (first == std::string::npos) return stem;
  return stem.substr(first + 1, stem.find('_', first + 1) - first - 1);
}

/// Starts of sections whose mean step is long enough.
std::vector<std::size_t> movingStarts(const std::vector<Vector2>& p, std::size_t n, double least) {
  std::vector<double> way(p.size(), 0);
  for (std::size_t i = 1; i < p.size(); ++i) way[i] = way[i - 1] + (p[i] - p[i - 1]).norm();
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i + n <= p.size(); ++i) {
    if ((way[i + n - 1] - way[i]) / static_cast<double>(n - 1) >= least) out.push_back(i);
  }
  return out;
}

std::vector<Vector2> sectionOf(const GpsTrack& t, std::size_t start, int n) {
  const auto from = t.p.begin() + static_cast<std::ptrdiff_t>(start);
  return {from, from + n};
}

/// Covariance of a receiver at rest.
Matrix2 stationaryNoise(const std::string& path) {
  const auto p = readPositionTrack(path).local();
  if (p.size() < 30) throw DataError(path + ": fewer than 30 fixes: expected a receiver at rest");
  Vector2 mean = Vector2::Zero();
  for (const auto& x : p) mean += x / static_cast<double>(p.size());
  Matrix2 R = Matrix2::Zero();
  for (const auto& x : p)
    R += (x - mean) * (x - mean).transpose() / (static_cast<double>(p.size()) - 1);
  return R;
}

/// Sections for the process noise: evenly from all users of the class.
std::vector<std::vector<Vector2>> trainingSections(const std::vector<GpsTrack>& tracks, int mode,
                                                   const std::string& without,
                                                   const GpsParams& params) {
  std::vector<std::pair<const GpsTrack*, std::size_t>> all;
  for (const auto& t : tracks) {
    if (t.mode != mode || t.user == without) continue;
    for (const auto s : t.starts) all.push_back({&t, s});
  }
  std::vector<std::vector<Vector2>> out;
  const std::size_t n = std::min(kTrainingSections, all.size());
  for (std::size_t i = 0; i < n; ++i) {
    const auto& [track, start] = all[(2 * i + 1) * all.size() / (2 * n)];
    out.push_back(sectionOf(*track, start, params.section));
  }
  return out;
}

std::vector<SpeedRegimes> learnRegimes(const std::vector<GpsTrack>& tracks,
                                       const std::set<std::string>& without) {
  std::vector<SpeedRegimes> out(kGpsModes);
  for (std::size_t mode = 0; mode < kGpsModes; ++mode) {
    std::map<std::string, std::vector<std::vector<int>>> by_user;
    for (const auto& t : tracks) {
      if (t.mode == static_cast<int>(mode) && without.count(t.user) == 0)
        by_user[t.user].push_back(t.bins);
    }
    for (const auto& [user, bins] : by_user) out[mode].add(bins);
    out[mode].finish();
  }
  return out;
}

std::vector<double> regimeScores(const std::vector<SpeedRegimes>& regimes, const GpsTrack& t,
                                 std::size_t start, int section) {
  std::vector<double> out;
  for (const auto& r : regimes)
    out.push_back(r.logLikelihood(t.bins, start, static_cast<std::size_t>(section) - 1));
  return out;
}

/// Smallest bias for the required pedestrian recall, by leave-one-user-out among training users.
double pedestrianBias(const std::vector<GpsTrack>& tracks, const std::vector<std::string>& users,
                      const std::string& without, const GpsParams& params) {
  std::vector<double> margins;  // pedestrian sections: log likelihood missing to be called one
  for (const auto& held_out : users) {
    if (held_out == without) continue;
    const auto regimes = learnRegimes(tracks, {without, held_out});
    for (const auto& t : tracks) {
      if (t.user != held_out || t.mode != 0) continue;
      for (std::size_t i = 0; i < t.starts.size(); i += 5) {
        const auto s = regimeScores(regimes, t, t.starts[i], params.section);
        margins.push_back(*std::max_element(s.begin() + 1, s.end()) - s[0]);
      }
    }
  }
  if (margins.empty()) return 0;
  std::sort(margins.begin(), margins.end());
  const auto index =
      static_cast<std::size_t>(params.pedestrian_recall * static_cast<double>(margins.size() - 1));
  return std::clamp(margins[index], 0.0, kMaxBias);
}

int called(const std::vector<double>& score) {
  return static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
}

int classify(const GpsExperiment& e, const GpsModel& model, const GpsTrack& t, std::size_t start,
             const GpsParams& params, GpsRule rule) {
  if (rule == GpsRule::kRegimes) {
    auto score = regimeScores(model.regimes, t, start, params.section);
    score[0] += model.pedestrian_bias;
    return called(score);
  }
  std::vector<double> score;
  const auto z = sectionOf(t, start, params.section);
  for (const auto& filter : model.filters) {
    const auto trace = runPaperFilter(filter, z, 1.0, e.R);
    double nis = 0, log_density = 0;
    for (std::size_t k = 0; k < trace.nis.size(); ++k) nis += trace.nis[k];
    for (std::size_t k = 2; k < trace.nis.size(); ++k) log_density += trace.log_density[k];
    score.push_back(rule == GpsRule::kChi2
                        ? logChi2Density(nis, 2 * static_cast<double>(trace.nis.size()))
                        : log_density);
  }
  return called(score);
}

}  // namespace

const std::vector<std::string>& gpsModes() {
  static const std::vector<std::string> modes = {"pedestrian", "cyclist", "car", "bus"};
  return modes;
}

std::vector<GpsTrack> readGpsTracks(const GpsParams& params) {
  namespace fs = std::filesystem;
  std::vector<GpsTrack> out;
  for (std::size_t mode = 0; mode < kGpsModes; ++mode) {
    const fs::path folder = fs::path(params.folder) / gpsModes()[mode];
    if (!fs::is_directory(folder))
      throw DataError(folder.string() +
                          ": no such folder: expected one for each of pedestrian, "
                          "cyclist, car, bus",
                      ExitCode::kNoInput);
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      const auto read = readPositionTrack(file);
      GpsTrack t;
      t.mode = static_cast<int>(mode);
      t.user = userOf(read.name);
      t.p = read.local();
      for (const auto& fix : read.fixes) t.t.push_back(fix.t);
      t.bins = SpeedRegimes::binsOf(t.t, t.p);
      t.starts = movingStarts(t.p, static_cast<std::size_t>(params.section), params.least_step);
      out.push_back(std::move(t));
    }
    const bool any = std::any_of(out.begin(), out.end(), [&](const GpsTrack& t) {
      return t.mode == static_cast<int>(mode) && !t.starts.empty();
    });
    if (!any)
      throw DataError(
          fmt::format("{}: no section of {} moving fixes", folder.string(), params.section));
  }
  return out;
}

GpsExperiment prepareGps(const GpsParams& params) {
  GpsExperiment e;
  e.R << 1.2, 0.1, 0.1, 1.2;  // [radecki2016]'s receiver [m^2]
  if (!params.stationary.empty()) e.R = stationaryNoise(params.stationary);
  e.tracks = readGpsTracks(params);
  std::set<std::string> users;
  for (const auto& t : e.tracks) users.insert(t.user);
  e.users.assign(users.begin(), users.end());
  if (e.users.size() < 2)
    throw DataError(params.folder +
                    ": one user only: expected files CLASS_USER_....csv of two "
                    "users or more, since each is tested by models of the others");
  e.models.resize(e.users.size());
  tbb::parallel_for(std::size_t{0}, e.users.size(), [&](std::size_t u) {
    GpsModel& model = e.models[u];
    for (std::size_t mode = 0; mode < kGpsModes; ++mode) {
      const auto sections = trainingSections(e.tracks, static_cast<int>(mode), e.users[u], params);
      model.filters.push_back(fitNoise(mode > 0, sections, e.R));
    }
    model.regimes = learnRegimes(e.tracks, {e.users[u]});
    model.pedestrian_bias = pedestrianBias(e.tracks, e.users, e.users[u], params);
  });
  return e;
}

GpsResult runGps(const GpsExperiment& e, const GpsParams& params, GpsRule rule) {
  const auto draws = static_cast<std::size_t>(params.draws);
  std::vector<std::vector<std::vector<double>>> counts(
      draws, std::vector<std::vector<double>>(kGpsModes, std::vector<double>(kGpsModes, 0)));
  tbb::parallel_for(std::size_t{0}, draws * kGpsModes, [&](std::size_t job) {
    const std::size_t draw = job / kGpsModes, mode = job % kGpsModes;
    std::vector<std::pair<std::size_t, std::size_t>> sections;
    for (std::size_t k = 0; k < e.tracks.size(); ++k) {
      if (e.tracks[k].mode != static_cast<int>(mode)) continue;
      for (const auto s : e.tracks[k].starts) sections.push_back({k, s});
    }
    Rng rng({params.seed, draw, static_cast<std::uint32_t>(mode), kPurpose});
    for (int i = 0; i < params.sections; ++i) {
      const auto& [k, start] = sections[rng.below(static_cast<std::uint32_t>(sections.size()))];
      const GpsTrack& track = e.tracks[k];
      const auto user = std::lower_bound(e.users.begin(), e.users.end(), track.user);
      const auto& model = e.models[static_cast<std::size_t>(user - e.users.begin())];
      const int c = classify(e, model, track, start, params, rule);
      counts[draw][mode][static_cast<std::size_t>(c)] += 1.0 / params.sections;
    }
  });
  GpsResult r;
  r.confusion.assign(kGpsModes, std::vector<double>(kGpsModes, 0));
  std::vector<double> balanced(draws, 0);
  for (std::size_t d = 0; d < draws; ++d) {
    for (std::size_t m = 0; m < kGpsModes; ++m) {
      balanced[d] += counts[d][m][m] / static_cast<double>(kGpsModes);
      for (std::size_t c = 0; c < kGpsModes; ++c)
        r.confusion[m][c] += counts[d][m][c] / static_cast<double>(draws);
    }
    r.balanced += balanced[d] / static_cast<double>(draws);
  }
  for (const double b : balanced)
    r.deviation += std::pow(b - r.balanced, 2) / std::max(1.0, static_cast<double>(draws) - 1);
  r.deviation = std::sqrt(r.deviation);
  for (std::size_t m = 0; m < kGpsModes; ++m) r.right.push_back(r.confusion[m][m]);
  return r;
}

}  // namespace perception
