#include "libperception/evaluation/metrics/Identities.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "libperception/core/math/Assignment.h"

namespace perception {
namespace {

constexpr int kLevels = 19;                       // similarities .05, .10 ... .95
constexpr double kSlack = 1e-9;                   // of their comparison
using Ids = std::pair<std::size_t, std::size_t>;  // of truth and estimate, both from 0

/// Numbers of identities in the order of their first appearance, and how often each was there.
template <class Id>
class Census {
 public:
  std::size_t add(Id id) {
    const auto [row, fresh] = number_.emplace(id, count.size());
    if (fresh) count.push_back(0);
    ++count[row->second];
    return row->second;
  }
  /// An identity of its own.
  std::size_t addAlone() {
    count.push_back(1);
    return count.size() - 1;
  }
  std::vector<double> count;

 private:
  std::map<Id, std::size_t> number_;
};

struct Instant {
  std::vector<std::size_t> truth, estimates;
};

/// Everything by number of identity.
struct Tracks {
  std::vector<Instant> instants;
  Census<std::int64_t> truth;
  Census<std::uint64_t> estimates;

  explicit Tracks(const std::vector<IdentityView>& views) {
    for (const IdentityView& view : views) {
      Instant& instant = instants.emplace_back();
      for (const std::int64_t id : view.truth)
        instant.truth.push_back(id < 0 ? truth.addAlone() : truth.add(id));
      for (const std::uint64_t id : view.estimates) instant.estimates.push_back(estimates.add(id));
    }
  }
  /// Instants at which one or both of two identities are there, given those with both.
  double either(const Ids& ids, double both) const {
    return truth.count[ids.first] + estimates.count[ids.second] - both;
  }
};

/// How much two identities belong together: the Jaccard index of their similarities.
std::map<Ids, double> alignment(const std::vector<IdentityView>& views, const Tracks& tracks) {
  std::map<Ids, double> together;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<double> of_truth(views[i].truth.size(), 0),
        of_estimate(views[i].estimates.size(), 0);
    for (const auto& p : views[i].pairs)
      of_truth[p.truth] += p.similarity, of_estimate[p.estimate] += p.similarity;
    for (const auto& p : views[i].pairs)
      together[{tracks.instants[i].truth[p.truth], tracks.instants[i].estimates[p.estimate]}] +=
          p.similarity / (of_truth[p.truth] + of_estimate[p.estimate] - p.similarity);
  }
  for (auto& [ids, value] : together) value /= tracks.either(ids, value);
  return together;
}

/// Pairs of an instant, one to one, of the greatest sum of alignment times similarity.
std::vector<IdentityView::Pair> pairsOf(const IdentityView& view, const Instant& instant,
                                        const std::map<Ids, double>& aligned) {
  if (view.pairs.empty()) return {};
  const auto rows = static_cast<Eigen::Index>(view.truth.size());
  const auto columns = static_cast<Eigen::Index>(view.estimates.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(rows, columns), similarity = cost;
  for (const auto& p : view.pairs) {
    const auto r = static_cast<Eigen::Index>(p.truth), c = static_cast<Eigen::Index>(p.estimate);
    similarity(r, c) = p.similarity;
    cost(r, c) =
        -p.similarity * aligned.at({instant.truth[p.truth], instant.estimates[p.estimate]});
  }
  const std::vector<int> column = optimalAssignment(cost);
  std::vector<IdentityView::Pair> pairs;
  for (std::size_t r = 0; r < column.size(); ++r) {
    if (column[r] < 0) continue;
    const double s = similarity(static_cast<Eigen::Index>(r), column[r]);
    if (s > 0) pairs.push_back({r, static_cast<std::size_t>(column[r]), s});
  }
  return pairs;
}

/// Instants of pairs of identities at one level of similarity.
struct Level {
  double matched = 0;
  std::map<Ids, double> together;
};

void setHota(const std::vector<IdentityView>& views, const Tracks& tracks, double truth,
             double estimates, IdentityFigures& figures) {
  const auto aligned = alignment(views, tracks);
  std::array<Level, kLevels> levels;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Instant& instant = tracks.instants[i];
    for (const auto& p : pairsOf(views[i], instant, aligned)) {
      for (int k = 0; k < kLevels && p.similarity + kSlack >= 0.05 * (k + 1); ++k) {
        Level& level = levels[static_cast<std::size_t>(k)];
        ++level.matched;
        ++level.together[{instant.truth[p.truth], instant.estimates[p.estimate]}];
      }
    }
  }
  double hota = 0, detection = 0, association = 0;
  for (const Level& level : levels) {
    double sum = 0;
    for (const auto& [ids, both] : level.together) sum += both * both / tracks.either(ids, both);
    const double det = level.matched / (truth + estimates - level.matched);
    const double ass = level.matched > 0 ? sum / level.matched : 0;
    detection += det / kLevels, association += ass / kLevels;
    hota += std::sqrt(det * ass) / kLevels;
  }
  figures.hota = hota, figures.detection = detection, figures.association = association;
}

/// Most instants of pairs of identities, one to one; a truth may stay alone.
double identityMatches(const std::vector<IdentityView>& views, const Tracks& tracks) {
  std::map<Ids, double> together;
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const auto& p : views[i].pairs)
      ++together[{tracks.instants[i].truth[p.truth], tracks.instants[i].estimates[p.estimate]}];
  const std::vector<int> column =
      pairIdentities(together, tracks.truth.count.size(), tracks.estimates.count.size());
  double instants = 0;
  for (std::size_t r = 0; r < column.size(); ++r)
    if (column[r] >= 0) instants += together.at({r, static_cast<std::size_t>(column[r])});
  return instants;
}

}  // namespace

std::vector<int> pairIdentities(const std::map<Ids, double>& together, std::size_t rows,
                                std::size_t columns) {
  double most = 0;
  for (const auto& [ids, instants] : together) most = std::max(most, instants);
  AssignmentSolver solver;
  solver.begin(static_cast<int>(columns + rows));
  auto next = together.begin();
  for (std::size_t r = 0; r < rows; ++r) {
    for (; next != together.end() && next->first.first == r; ++next)
      solver.addOption(static_cast<int>(next->first.second), most - next->second);
    solver.addOption(static_cast<int>(columns + r), most);
    solver.endRow();
  }
  std::vector<int> column = solver.solve().column;
  for (int& c : column)
    if (c >= static_cast<int>(columns)) c = -1;
  return column;
}

IdentityView identityView(std::vector<std::int64_t> truth, const std::vector<Vector2>& truth_at,
                          std::vector<std::uint64_t> estimates,
                          const std::vector<Vector2>& estimates_at, double reach) {
  IdentityView view{std::move(truth), std::move(estimates), {}};
  for (std::size_t t = 0; t < truth_at.size(); ++t) {
    for (std::size_t e = 0; e < estimates_at.size(); ++e) {
      const double similarity = 1 - (truth_at[t] - estimates_at[e]).norm() / reach;
      if (similarity > 0) view.pairs.push_back({t, e, similarity});
    }
  }
  return view;
}

IdentityFigures identityFigures(const std::vector<IdentityView>& instants) {
  IdentityFigures figures;
  double truth = 0, estimates = 0;
  for (const IdentityView& view : instants) {
    truth += static_cast<double>(view.truth.size());
    estimates += static_cast<double>(view.estimates.size());
  }
  if (truth <= 0) return figures;
  const Tracks tracks(instants);
  setHota(instants, tracks, truth, estimates, figures);
  figures.idf1 = 2 * identityMatches(instants, tracks) / (truth + estimates);
  return figures;
}

}  // namespace perception
