#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// What counts as the same in two runs.
struct DifferenceOptions {
  double reach = 2;  ///< [m] at most between centers of the same object: [radecki2016]
  /// [s] at most between scenes of the same instant; assumed: half the period of a 10 Hz lidar.
  double same_instant = 0.05;
};

/// One identity of a run, compared with another run.
struct ComparedIdentity {
  /// What the other run has at that place.
  enum class Other {
    kMatched,    ///< an object in reach, the pair or another one
    kNone,       ///< nothing in reach
    kNoInstant,  ///< no scene: before its first or after its last common instant
  };
  /// A time interval with one class.
  struct Stretch {
    double from = 0, to = 0;  ///< [s] of the log
    std::size_t class_index = 0;
    Other other = Other::kMatched;
  };
  std::uint64_t id = 0;
  double first = 0, last = 0;               ///< [s] of the log
  std::size_t instants = 0;                 ///< at which it is there
  std::size_t compared = 0;                 ///< of them common to both runs
  std::size_t last_class = 0;               ///< most probable class at the end
  double last_probability = 0;              ///< of that class
  std::vector<std::size_t> class_instants;  ///< at which each class was most probable
  /// Instants at which it was matched, by identity of the other run.
  std::map<std::uint64_t, std::size_t> matched;
  std::size_t switches = 0;        ///< times that identity changed
  std::vector<Stretch> stretches;  ///< over the common instants, and outside of their range
};

/// Identities of both runs that belong together, or one alone.
struct IdentityDifference {
  std::optional<ComparedIdentity> a, b;
  std::size_t together = 0;       ///< instants matched with each other
  std::size_t classes_apart = 0;  ///< of them, with different most probable classes
  std::size_t values_apart = 0;   ///< of them, with any value of tracks.csv different but the id
  double distance_rms = 0;        ///< [m] of the centers, over the instants together
  /// Instants at which the two differ: only one of them is there, it is matched with another
  /// object, or its class is another. For an identity without a counterpart, all its instants.
  std::size_t apart = 0;
};

/// Counts of one run.
struct RunFigures {
  std::size_t scenes = 0;
  std::size_t objects = 0;     ///< over all scenes: lines of tracks.csv
  std::size_t sure = 0;        ///< of them classified
  std::size_t identities = 0;  ///< different ids
  double objectsPerInstant() const;
};

/// Two runs of the same log, compared object by object.
struct RunDifference {
  RunFigures a, b;
  std::vector<std::string> classes;    ///< of both runs: those of A, then others of B
  std::size_t common = 0;              ///< instants
  std::size_t shifted = 0;             ///< of them with different stamps
  std::size_t only_a = 0, only_b = 0;  ///< instants of one run
  std::size_t ego_apart = 0;           ///< common instants with another pose of the vehicle
  std::size_t path_apart = 0;          ///< common instants with another free path
  std::size_t pairs = 0;               ///< pairs of identities
  double end = 0;                      ///< [s] of the log, of the last scene
  /// Identities that differ in anything, those apart most first.
  std::vector<IdentityDifference> rows;

  /// The same scenes, but for the numbers of their objects.
  bool none() const;
};

/// Compares runs of the same log. Objects of an instant are matched one to one with the least sum
/// of distances [m], where an object without one counts as the reach; B's places are moved to the
/// stamp of A by their velocity. Identities are paired as for IDF1 [ristani2016].
RunDifference compareRuns(const TrackedRun& a, const TrackedRun& b,
                          const DifferenceOptions& options = {});

}  // namespace perception
