#pragma once
#include <tbb/scalable_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/core/Kinematics.h"
#include "libperception/core/Time.h"
#include "libperception/filter/state/Heading.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// One motion mode of a class filter (interacting models): its Gaussian, in the class filter's
/// coordinates.
struct ModeFilter {
  double log_probability = 0;  ///< of the mode, given the class
  Vector4 x = Vector4::Zero();
  Matrix4 P = Matrix4::Zero();
};

/// The Gaussian of one class in a track's bank. The meaning of the state depends on the class's
/// motion: constant velocity [x, y, vx, vy]; wheeled [x, y, v, theta] once `oriented`, before that
/// as constant velocity; static [x, y, 0, 0] with zero covariance in the last two. World, SI units.
struct ClassFilter {
  Vector4 x = Vector4::Zero();
  Matrix4 P = Matrix4::Zero();
  Extent extent;
  bool oriented = false;       ///< wheeled only: the heading is known, up to its direction
  FrontBackAmbiguity heading;  ///< of an oriented filter
  std::vector<ModeFilter>
      modes;  ///< of classes with several; x and P are then their mean and spread
};

/// One filter a class. Larger than what the C library keeps at hand, and made and given back many
/// times a scan: TBB's allocator.
using Bank = std::vector<ClassFilter, tbb::scalable_allocator<ClassFilter>>;

/// How a sensor's last measurement of an object lay off its filter after the update: detectors err
/// alike from one scan to the next.
struct RegionSeen {
  std::uint64_t sensor = 0;  ///< hash of its label
  Stamp stamp;
  AxisMask seen = 0;
  AxisVector error;  ///< z - h of the axes seen, packed
};

/// A disc about the means of all class filters, and how fast it grows: what tells whether a sensor
/// can see the track without predicting it.
struct ReachableDisc {
  Vector2 center = Vector2::Zero();  ///< [m] world
  /// [m] radius of the disc at the track's time; without bounds until somebody asked.
  double reach = std::numeric_limits<double>::infinity();
  double speed = 0;             ///< [m/s] of the fastest mean
  double longest_deferral = 0;  ///< [s] for which it may be left behind, unseen
  /// When no sensor sees it until then, its existence has fallen below what is kept.
  Stamp expires{std::numeric_limits<std::int64_t>::max()};
};

/// One object inside a hypothesis. Immutable once made: hypotheses share it.
struct Track {
  std::uint64_t id =
      0;  ///< of its birth: (scan index << 16) + measurement; shared by all hypotheses
  std::uint64_t history = 0;  ///< hash of its association history: equal histories, equal tracks
  Stamp birth, stamp;         ///< of its first measurement; of its state
  Stamp last_in_view;         ///< last time that a sensor could have seen it
  Stamp last_lane;            ///< last time that a lane spoke of its heading; 0 = never
  double existence = 0;       ///< probability that it is a real object
  Bank bank;                  ///< one filter a class
  ClassId decided_class =
      -1;  ///< the class that is decided: its filter alone is kept up to date; -1: all
  std::vector<double> log_class;  ///< log class probabilities, given existence; sum of exp is 1
  ScalarEstimate base_z, height;  ///< [m] lowest point, world; lowest to highest point
  /// [m] along and across the heading, of complete sides, whatever the class: evidence of it. What
  /// each class makes of the size is its filter's `extent`.
  ScalarEstimate length, width;
  /// Where an object whose class has no heading in its state (people) looks: [rad] world, once a
  /// detector told.
  std::optional<ScalarEstimate> body_heading;
  FrontBackAmbiguity body_heading_bit;            ///< of it: front or back
  std::array<Stamp, kMostModalities> last_hit{};  ///< by modality (modalityIndex); 0 = never
  std::array<int, kMostModalities> hits{};        ///< by modality
  std::vector<RegionSeen> regions;                ///< by sensor, where the model asks for them
  ReachableDisc reachable;  ///< made from the rest when a scan is done with it
  /// What it was before its last scan, for as long as somebody keeps that; only where the model
  /// asks for a history.
  std::weak_ptr<const Track> previous;

  /// Index of the most probable class.
  ClassId likeliestClass() const;
  /// Whether the class's filter is kept up to date.
  bool live(ClassId c) const { return decided_class < 0 || decided_class == c; }
  /// Index of the filter that stands for the class.
  std::size_t filterOf(std::size_t c) const {
    return decided_class < 0 ? c : static_cast<std::size_t>(decided_class);
  }
};

using TrackHandle = std::shared_ptr<const Track>;
/// All distinct tracks after a scan; what no hypothesis has is null.
using TrackTable = std::vector<TrackHandle>;

/// The tracks of one hypothesis: places in a table that all hypotheses of a scan share, so that a
/// thousand of them cost numbers and not handles.
class TrackList {
 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = TrackHandle;
    using difference_type = std::ptrdiff_t;
    using pointer = const TrackHandle*;
    using reference = const TrackHandle&;
    Iterator(const TrackTable* table, const std::uint32_t* place) : table_(table), place_(place) {}
    reference operator*() const { return (*table_)[*place_]; }
    pointer operator->() const { return &**this; }
    Iterator& operator++() { return ++place_, *this; }
    Iterator operator++(int) { return {table_, place_++}; }
    bool operator==(const Iterator& other) const { return place_ == other.place_; }
    bool operator!=(const Iterator& other) const { return place_ != other.place_; }

   private:
    const TrackTable* table_;
    const std::uint32_t* place_;
  };

  TrackList() = default;
  explicit TrackList(TrackTable tracks);
  /// `places` of tracks that are there.
  TrackList(std::shared_ptr<const TrackTable> table, std::vector<std::uint32_t> places)
      : table_(std::move(table)), places_(std::move(places)) {}

  Iterator begin() const { return {table_.get(), places_.data()}; }
  Iterator end() const { return {table_.get(), places_.data() + places_.size()}; }
  std::size_t size() const { return places_.size(); }
  bool empty() const { return places_.empty(); }
  const TrackHandle& operator[](std::size_t i) const { return (*table_)[places_[i]]; }

  const TrackTable* table() const { return table_.get(); }  ///< may be null where there is no track
  const std::vector<std::uint32_t>& places() const { return places_; }

 private:
  std::shared_ptr<const TrackTable> table_;
  std::vector<std::uint32_t> places_;
};

/// A sampled association history and the tracks that follow from it, in order of their birth.
/// Immutable once made: particles share it.
struct Hypothesis {
  TrackList tracks;
  std::uint64_t key = 0;  ///< of the tracks' histories, in any order: equal keys, equal hypotheses

  Hypothesis() = default;
  explicit Hypothesis(TrackTable t);
  Hypothesis(TrackList list, std::uint64_t k) : tracks(std::move(list)), key(k) {}
};

/// What a track adds to the key of its hypothesis.
std::uint64_t historyKey(const Track& track);

/// What a particle holds. Never null.
using HypothesisHandle = std::shared_ptr<const Hypothesis>;

/// The history after one more association; `scan` counts scans, `measurement` is its index in that
/// scan.
std::uint64_t extendHistory(std::uint64_t history, std::uint64_t scan, std::size_t measurement);
inline std::uint64_t birthId(std::uint64_t scan, std::size_t measurement) {
  return (scan << 16) + measurement;
}

/// Posterior class probabilities as numbers (exp of log_class).
std::vector<double> classProbabilities(const Track& track);

}  // namespace perception
