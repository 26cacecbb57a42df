#pragma once
#include <tbb/scalable_allocator.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Kinematics.h"
#include "libperception/core/Time.h"
#include "libperception/filter/state/Heading.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// One motion mode of a class filter (IMM): its Gaussian in the class filter's state space.
struct ModeFilter {
  double log_probability = 0;  ///< of the mode, given the class
  Vector4 x = Vector4::Zero();
  Matrix4 P = Matrix4::Zero();
};

/// The Gaussian of one class in a track's bank. The state depends on the class's motion model:
/// constant velocity [x, y, vx, vy]; wheeled [x, y, v, theta] once `oriented`, before that as
/// constant velocity; static [x, y, 0, 0] with zero covariance in the last two. World, SI units.
struct ClassFilter {
  Vector4 x = Vector4::Zero();
  Matrix4 P = Matrix4::Zero();
  Extent extent;
  bool oriented =
      false;  ///< wheeled only: the state is [x, y, v, theta]; theta known up to 180 degrees
  FrontBackAmbiguity heading;  ///< of an oriented filter
  std::vector<ModeFilter>
      modes;  ///< empty unless the class has several; x and P are then the moments of the mixture
};

/// TBB's allocator: banks are too large for malloc's thread caches and are allocated many times a
/// scan. ThreadSanitizer cannot see that it hands memory from thread to thread in order.
#ifdef __SANITIZE_THREAD__
using BankAllocator = std::allocator<ClassFilter>;
#else
using BankAllocator = tbb::scalable_allocator<ClassFilter>;
#endif

/// One filter per class.
using Bank = std::vector<ClassFilter, BankAllocator>;

/// Residual of a sensor's last measurement of an object after the update, for correlated errors
/// ([filter] region_memory).
struct RegionSeen {
  std::uint64_t sensor = 0;  ///< hash of its label
  Stamp stamp;
  AxisMask seen = 0;
  AxisVector error;  ///< z - h, axes seen only
};

/// What a sensor has said of the object's class so far (MeasurementModel::evidenceMemory()).
struct EvidenceSeen {
  std::uint64_t sensor = 0;  ///< hash of its label
  Stamp stamp;               ///< of the last view
  EvidenceView view;
  double views = 0;          ///< independent looks, but for the part of the errors that stays
  double returns = 1;        ///< mean number of returns of a look
  std::vector<double> mean;  ///< of Measurement::log_class, over all returns of all looks
  double phantom = 0;        ///< the same of PhantomLook::evidence
};

/// A disc that contains the means of all class filters and its growth over time: tells whether a
/// sensor may see the track without predicting it.
struct ReachableDisc {
  Vector2 center = Vector2::Zero();  ///< [m] world
  /// [m] radius of the disc at the track's stamp; infinite until computed.
  double reach = std::numeric_limits<double>::infinity();
  double speed = 0;             ///< [m/s] largest speed of the means
  double longest_deferral = 0;  ///< [s] longest deferral of the prediction
  /// Without a detection until then, the existence probability falls below `existence_min`.
  Stamp expires{std::numeric_limits<std::int64_t>::max()};
};

/// Share of newborn things of which what is seen goes along with the sensor's vehicle (assumed).
inline constexpr double kGoesAlong = 0.2;

/// One object in a hypothesis. Immutable, since hypotheses share tracks.
struct Track {
  std::uint64_t id = 0;       ///< birthId(); the same in all hypotheses
  std::uint64_t history = 0;  ///< hash of its association history: equal histories, equal tracks
  Stamp birth, stamp;         ///< of the first measurement; of the state
  Stamp last_in_view;         ///< last scan in whose field of view it was
  Stamp last_lane;            ///< last update by the lane prior; 0 = never
  double existence = 0;       ///< probability that its detections have a cause that goes on
  /// Probability that this cause is a phantom and not an object, given existence.
  double phantom = 0;
  /// Probability that it stands, if it is a vehicle: without it every view of a waiting car would
  /// say that it is rather something that never moves.
  double stands = 0.5;
  /// Probability that what is seen of it goes along with the vehicle of the sensor, if it is a
  /// thing: a beam meets a guard rail always at the same distance.
  double goes_along = kGoesAlong;
  Bank bank;  ///< one filter a class
  ClassId decided_class =
      -1;  ///< if >= 0 only this class's filter is updated ([filter] decide_class)
  std::vector<double> log_class;  ///< log class probabilities given existence; normalized
  ScalarEstimate base_z, height;  ///< [m] lowest point, world; lowest to highest point
  /// [m] from complete sides, without a class prior: evidence of the class. The estimate given a
  /// class is the `extent` of its filter.
  ScalarEstimate length, width;
  /// The same, but a side that fits a vehicle better across its heading is taken so: evidence
  /// between classes of one shape.
  ScalarEstimate fitting_length, fitting_width;
  double longest = 0;  ///< [m] of the sides that clusters of it showed as a likely vehicle
  /// [rad] world. Body heading of an object whose class has no heading in its state (people); set
  /// by the first detection with a heading.
  std::optional<ScalarEstimate> body_heading;
  FrontBackAmbiguity body_heading_bit;  ///< front/back bit of body_heading
  std::optional<Vector2> walked_from;   ///< [m] world; from here on its way tells body_heading
  std::array<Stamp, kMostModalities> last_hit{};  ///< by modality (modalityIndex); 0 = never
  std::array<int, kMostModalities> hits{};        ///< by modality
  /// Since the last hit: detections that a sensor which tells classes by shape should have had.
  double missed = 0;
  std::vector<RegionSeen> regions;     ///< by sensor, only with [filter] region_memory > 0
  std::vector<EvidenceSeen> evidence;  ///< by sensor
  ReachableDisc reachable;             ///< computed at the end of the update
  /// State before the last scan, valid while CRbpfTracker keeps that hypothesis; only with
  /// FilterModel::history > 0.
  std::weak_ptr<const Track> previous;

  /// Probability that it is a real object.
  double real() const { return existence * (1 - phantom); }
  /// Share of the evidence of its class that counts: what was seen a few times and is not seen
  /// again where it should be was rather a part of something else.
  double shareOfEvidence() const;
  /// Index of the most probable class.
  ClassId likeliestClass() const;
  /// Whether the class's filter is updated.
  bool live(ClassId c) const { return decided_class < 0 || decided_class == c; }
  /// Index of the filter used for the class: with a decided class, that one's.
  std::size_t filterOf(std::size_t c) const {
    return decided_class < 0 ? c : static_cast<std::size_t>(decided_class);
  }
};

using TrackHandle = std::shared_ptr<const Track>;
/// All distinct tracks after a scan; entries that no hypothesis holds are null.
using TrackTable = std::vector<TrackHandle>;

/// The tracks of one hypothesis as indices into a table that all hypotheses of a scan share:
/// cheaper than a list of shared pointers each.
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
  /// `places`: indices of non-null entries.
  TrackList(std::shared_ptr<const TrackTable> table, std::vector<std::uint32_t> places)
      : table_(std::move(table)), places_(std::move(places)) {}

  Iterator begin() const { return {table_.get(), places_.data()}; }
  Iterator end() const { return {table_.get(), places_.data() + places_.size()}; }
  std::size_t size() const { return places_.size(); }
  bool empty() const { return places_.empty(); }
  const TrackHandle& operator[](std::size_t i) const { return (*table_)[places_[i]]; }

  const TrackTable* table() const { return table_.get(); }  ///< may be null if the list is empty
  const std::vector<std::uint32_t>& places() const { return places_; }

 private:
  std::shared_ptr<const TrackTable> table_;
  std::vector<std::uint32_t> places_;
};

/// The last state of a track that was dropped, and the scan at which it was.
struct EndedTrack {
  TrackHandle track;
  Stamp end;
};

/// An association history and its tracks in order of birth. Immutable, since particles share
/// hypotheses.
struct Hypothesis {
  TrackList tracks;
  std::uint64_t key =
      0;  ///< order-independent hash of the tracks' histories: equal keys, equal hypotheses
  /// Tracks dropped within the last FilterModel::history seconds: late scenes show them.
  std::vector<EndedTrack> ended;

  Hypothesis() = default;
  explicit Hypothesis(TrackTable t);
  Hypothesis(TrackList list, std::uint64_t k) : tracks(std::move(list)), key(k) {}
};

/// Contribution of a track to Hypothesis::key.
std::uint64_t historyKey(const Track& track);

/// The value of a particle. Never null.
using HypothesisHandle = std::shared_ptr<const Hypothesis>;

/// The history after one more association; `scan` counts scans, `measurement` is its index in that
/// scan.
std::uint64_t extendHistory(std::uint64_t history, std::uint64_t scan, std::size_t measurement);
inline std::uint64_t birthId(std::uint64_t scan, std::size_t measurement) {
  return (scan << 16) + measurement;
}

/// Hash of a sensor's label (FNV-1a: the same on every machine).
std::uint64_t sensorKey(const std::string& label);

/// Posterior class probabilities as numbers (exp of log_class).
std::vector<double> classProbabilities(const Track& track);
/// The same with the share of the evidence that counts; as they are output.
std::vector<double> classProbabilities(const Track& track, const ClassTable& classes);

}  // namespace perception
