#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"

namespace perception {

/// How well the innovations of one sensor and class agree with their covariances (method.md 11.3).
struct InnovationSums {
  std::uint64_t updates = 0;     ///< measurements that updated a track
  std::uint64_t axes = 0;        ///< of all these
  double squares = 0;            ///< sum of NIS = y' S^-1 y; expected: `axes`
  std::uint64_t pairs_axes = 0;  ///< axes of successive updates of one track, same axes seen
  double products = 0;           ///< sum of e_k' e_(k-1), e = L^-1 y, S = L L'
  double pair_squares = 0;       ///< sum of e_k' e_k over the same

  double nis() const { return squares / static_cast<double>(axes); }  ///< [-] per axis; 1
  double lag1() const { return products / pair_squares; }             ///< [-] 0: white
  InnovationSums& operator+=(const InnovationSums& other);
};

/// Collects the innovations of the most probable hypothesis: of tracks of high existence that were
/// there before the scan, by the filter of their most probable class. Tracks do not depend on it.
class InnovationWatch {
 public:
  /// Sensor label and class.
  using Sums = std::map<std::pair<std::string, ClassId>, InnovationSums>;

  /// Before the scan is processed.
  void before(const CRbpfTracker& tracker);
  /// After it was; `index`: CRbpfTracker::scans() before it.
  void after(const CRbpfTracker& tracker, const MeasurementScan& scan, std::uint64_t index);
  const Sums& sums() const { return sums_; }

 private:
  struct Last {
    Stamp stamp;
    AxisMask seen = 0;
    AxisVector standardized;
  };
  void add(const Track& before, const Track& after, const MeasurementScan& scan,
           std::size_t measurement, const FilterModel& model);

  std::vector<TrackHandle> before_;
  std::unordered_map<std::uint64_t, Last> last_;  ///< by track and sensor
  Sums sums_;
};

/// innovations.csv: a line a sensor and class (libperception/README.md).
std::string innovationsCsv(const InnovationWatch::Sums& sums, const ClassTable& classes);

}  // namespace perception
