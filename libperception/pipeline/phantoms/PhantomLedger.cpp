#include "libperception/pipeline/phantoms/PhantomLedger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr double kWindow = 2;        // [s] over which phantom clusters are counted; assumed
constexpr double kNotableFrom = 3;   // [clusters per scan] mean at which they begin to be notable
constexpr double kNotableUntil = 1;  // [clusters per scan] mean at which they end to be; assumed
/// Least share of a cluster's returns that are doubted for their cause to be the cluster's
/// (assumed): returns of the least trust are no obstacles and not in clusters.
constexpr double kLeastDoubted = 0.1;

double rounded(double value) { return std::round(100 * value) / 100; }

template <class Counts>
std::size_t mostFrequent(const Counts& counts) {
  return static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

std::size_t causeOf(const PhantomCluster& cluster,
                    const std::function<std::optional<Doubt>(std::uint32_t)>& doubt) {
  std::array<std::size_t, kDoubtCauses> causes{};
  for (const std::uint32_t i : cluster.doubted)
    if (const auto why = doubt(i)) ++causes[static_cast<std::size_t>(why->cause)];
  const auto doubted =
      static_cast<double>(std::accumulate(causes.begin(), causes.end(), std::size_t{0}));
  const bool known = doubted > 0 && doubted >= kLeastDoubted * static_cast<double>(cluster.returns);
  return known ? mostFrequent(causes) : ClusterLedger::kByShape;
}

/// Of the causes that occurred: returns and mean evidence [log-odds].
EventLog::Fields fieldsOf(const DoubtCounts& doubts) {
  EventLog::Fields fields = EventLog::Fields::object();
  for (std::size_t c = 0; c < kDoubtCauses; ++c) {
    if (doubts.returns[c] == 0) continue;
    EventLog::Fields& field = fields[kDoubtCauseNames[c]];
    field["returns"] = doubts.returns[c];
    if (static_cast<DoubtCause>(c) != DoubtCause::kMirror)
      field["log_odds"] = rounded(doubts.evidence[c] / static_cast<double>(doubts.returns[c]));
  }
  return fields;
}

EventLog::Fields fieldsOf(const ClusterLedger& clusters) {
  const std::size_t total = clusters.total();
  EventLog::Fields fields = {{"judged", clusters.clusters},
                             {"suspicious", clusters.suspicious},
                             {"phantoms", total},
                             {"returns", clusters.returns}};
  if (total > 0) fields["probability"] = rounded(clusters.probability / static_cast<double>(total));
  EventLog::Fields& causes = fields["causes"] = EventLog::Fields::object();
  for (std::size_t c = 0; c < ClusterLedger::kCauses; ++c)
    if (clusters.phantoms[c] > 0) causes[ClusterLedger::nameOf(c)] = clusters.phantoms[c];
  return fields;
}

}  // namespace

const char* ClusterLedger::nameOf(std::size_t cause) {
  return cause < kDoubtCauses ? kDoubtCauseNames[cause] : "shape";
}

ClusterLedger ClusterLedger::of(const ClusterVerdicts& verdicts,
                                const std::function<std::optional<Doubt>(std::uint32_t)>& doubt) {
  ClusterLedger ledger;
  ledger.clusters = verdicts.clusters, ledger.suspicious = verdicts.suspicious;
  for (const PhantomCluster& phantom : verdicts.phantoms) {
    ++ledger.phantoms[causeOf(phantom, doubt)];
    ledger.returns += phantom.returns, ledger.probability += phantom.probability;
  }
  return ledger;
}

std::size_t ClusterLedger::total() const {
  return std::accumulate(phantoms.begin(), phantoms.end(), std::size_t{0});
}

ClusterLedger& ClusterLedger::operator+=(const ClusterLedger& other) {
  clusters += other.clusters, suspicious += other.suspicious, returns += other.returns;
  probability += other.probability;
  for (std::size_t c = 0; c < kCauses; ++c) phantoms[c] += other.phantoms[c];
  return *this;
}

void PhantomLedger::add(LedgerRow row) {
  Lidar& lidar = lidars_[row.sensor];
  ++lidar.scans;
  last_ = row.stamp;
  lidar.trust.returns += row.trust.returns, lidar.trust.phantoms += row.trust.phantoms;
  lidar.trust.weight_lost += row.trust.weight_lost, lidar.trust.doubts += row.trust.doubts;
  if (row.clusters) {
    ++lidar.judged_scans;
    lidar.clusters += *row.clusters;
    watch(row.sensor, lidar, row.stamp, *row.clusters);
  }
  rows_.push_back(std::move(row));
}

void PhantomLedger::watch(const std::string& sensor, Lidar& lidar, Stamp now,
                          const ClusterLedger& clusters) {
  auto& recent = lidar.recent;
  if (recent.empty() || now < recent.back().stamp || now - recent.back().stamp > kWindow)
    recent.clear(), lidar.since = now;
  recent.push_back({now, clusters});
  while (now - recent.front().stamp >= kWindow) recent.pop_front();
  if (now - *lidar.since < kWindow) return;
  ClusterLedger sum;
  for (const Recent& scan : recent) sum += scan.clusters;
  const double mean = static_cast<double>(sum.total()) / static_cast<double>(recent.size());
  if (lidar.notable ? mean > kNotableUntil : mean < kNotableFrom) return;
  lidar.notable = !lidar.notable;
  EventLog::Fields fields = {{"sensor", sensor}, {"per_scan", rounded(mean)}};
  std::string message = fmt::format("{}: {:.1f} phantom clusters a scan", sensor, mean);
  if (sum.total() > 0) {
    const std::size_t cause = mostFrequent(sum.phantoms);
    fields["cause"] = ClusterLedger::nameOf(cause);
    fields["share"] =
        rounded(static_cast<double>(sum.phantoms[cause]) / static_cast<double>(sum.total()));
    message += fmt::format(", most by {}", ClusterLedger::nameOf(cause));
  }
  events_.add(now, lidar.notable ? event_kind::kPhantomsBegin : event_kind::kPhantomsEnd, message,
              std::move(fields));
}

std::vector<LedgerRow> PhantomLedger::take() { return std::exchange(rows_, {}); }

void PhantomLedger::finish() {
  if (lidars_.empty()) return;
  EventLog::Fields fields = EventLog::Fields::object();
  std::string message;
  for (const auto& [label, lidar] : lidars_) {
    EventLog::Fields& field = fields[label];
    field = {{"scans", lidar.scans},
             {"returns", lidar.trust.returns},
             {"weight_lost", rounded(lidar.trust.weight_lost)},
             {"doubted", fieldsOf(lidar.trust.doubts)}};
    message += fmt::format("{}{}: {} of {} returns doubted", message.empty() ? "" : "; ", label,
                           lidar.trust.doubts.total(), lidar.trust.returns);
    if (lidar.judged_scans == 0) continue;
    field["clusters"] = fieldsOf(lidar.clusters);
    message += fmt::format(", {} of {} clusters phantoms", lidar.clusters.total(),
                           lidar.clusters.clusters);
  }
  events_.add(last_, event_kind::kPhantoms, message, std::move(fields));
}

LedgerFile::LedgerFile(const std::string& path, Stamp first_stamp)
    : file_(path), first_stamp_(first_stamp) {
  std::string head = "t,stamp,sensor,returns,weight_lost";
  for (const char* cause : kDoubtCauseNames) head += fmt::format(",{}", cause);
  head += ",clusters,suspicious,phantom_clusters,phantom_returns,phantom_p";
  for (std::size_t c = 0; c < ClusterLedger::kCauses; ++c)
    head += fmt::format(",clusters_{}", ClusterLedger::nameOf(c));
  file_.write(head + '\n');
}

void LedgerFile::write(const LedgerRow& row) {
  std::string line = decimalSeconds(row.stamp.ns - first_stamp_.ns) + ',' +
                     decimalSeconds(row.stamp.ns) + ',' + row.sensor +
                     fmt::format(",{},", row.trust.returns) + fixedPlaces(row.trust.weight_lost, 2);
  for (const std::size_t n : row.trust.doubts.returns) line += fmt::format(",{}", n);
  if (row.clusters) {
    const ClusterLedger& c = *row.clusters;
    const std::size_t total = c.total();
    line += fmt::format(",{},{},{},{},", c.clusters, c.suspicious, total, c.returns);
    if (total > 0)
      line += fixedPlaces(c.probability / static_cast<double>(total), kProbabilityPlaces);
    for (const std::size_t n : c.phantoms) line += fmt::format(",{}", n);
  } else {
    line += std::string(5 + ClusterLedger::kCauses, ',');
  }
  file_.write(line + '\n');
}

}  // namespace perception
