#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/measurement/frames/ClusterVerdicts.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/weather/PointFilter.h"

namespace perception {

/// The clusters of a lidar scan that were judged phantoms, and why (method.md 9.13). Cause `k`
/// below kDoubtCauses: most of its doubted returns have that one; kByShape: the classifier alone
/// says so.
struct ClusterLedger {
  static constexpr std::size_t kCauses = kDoubtCauses + 1, kByShape = kDoubtCauses;
  static const char* nameOf(std::size_t cause);

  std::size_t clusters = 0;                     ///< judged
  std::size_t suspicious = 0;                   ///< kept although likelier a phantom than not
  std::size_t returns = 0;                      ///< of the phantoms
  double probability = 0;                       ///< sum of P(phantom) over the phantoms
  std::array<std::size_t, kCauses> phantoms{};  ///< clusters by cause

  /// `doubt`: why a return of the frame's cloud is doubted; empty: it is not.
  static ClusterLedger of(const ClusterVerdicts& verdicts,
                          const std::function<std::optional<Doubt>(std::uint32_t)>& doubt);
  std::size_t total() const;  ///< phantoms of all causes
  ClusterLedger& operator+=(const ClusterLedger& other);
};

/// What of a lidar scan was not taken as a surface.
struct LedgerRow {
  Stamp stamp;
  std::string sensor;
  TrustStats trust;
  std::optional<ClusterLedger> clusters;  ///< empty: clusters are not told by their shape
};

/// Accounts for the returns and clusters that were taken as phantoms, of all lidars whose returns
/// are weighed ([weather] filter = trust). Events: where phantom clusters begin and end to be
/// notable, and the totals of the run. Tracks do not depend on it.
class PhantomLedger {
 public:
  explicit PhantomLedger(EventLog& events) : events_(events) {}

  /// A scan, in order of time.
  void add(LedgerRow row);
  /// Rows since the last call.
  std::vector<LedgerRow> take();
  /// At the end of the log: the event with the totals at its last scan, if there was one.
  void finish();

 private:
  struct Recent {
    Stamp stamp;
    ClusterLedger clusters;
  };
  struct Lidar {
    std::size_t scans = 0, judged_scans = 0;
    TrustStats trust;            ///< sums
    ClusterLedger clusters;      ///< sums
    std::optional<Stamp> since;  ///< of the first scan without a gap up to now
    std::deque<Recent> recent;   ///< scans of the window
    bool notable = false;
  };
  void watch(const std::string& sensor, Lidar& lidar, Stamp now, const ClusterLedger& clusters);

  EventLog& events_;
  std::map<std::string, Lidar> lidars_;
  Stamp last_;  ///< of the last scan
  std::vector<LedgerRow> rows_;
};

/// ledger.csv: a line per lidar scan (libperception/README.md).
class LedgerFile {
 public:
  /// Throws OutputError.
  LedgerFile(const std::string& path, Stamp first_stamp);
  void write(const LedgerRow& row);
  void close() { file_.close(); }

 private:
  OutputFile file_;
  Stamp first_stamp_;
};

}  // namespace perception
