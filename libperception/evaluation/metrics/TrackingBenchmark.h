#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/evaluation/matching/TruthAlignment.h"

namespace perception {

/// An object of the truth or a track in one frame of the benchmark.
struct BenchmarkBox {
  std::int64_t id = -1;
  Vector2 center = Vector2::Zero();  ///< [m] on the ground
  double score = 0;                  ///< of a track; its mean over all frames counts
};
/// One key frame, of one class.
struct BenchmarkFrame {
  std::vector<BenchmarkBox> truth, tracks;
};

/// Figures of one class in nuScenes' tracking benchmark.
struct BenchmarkFigures {
  std::string name;       ///< car, pedestrian ...
  std::size_t truth = 0;  ///< boxes of the truth
  /// Mean over 40 recalls from 0.1 to 1 of MOTAR = max(0, 1 - (switches + false + missed - (1 - r)
  /// truth) / (r truth)), r: the recall of the tracks whose score reaches the threshold of that
  /// recall; 0 where a recall is not reached.
  double amota = 0;
  double amotp =
      2;  ///< [m] mean over the same recalls of the error of centers; 2 m where not reached
  double recall = 0;                          ///< of all tracks
  std::size_t switches = 0, false_boxes = 0;  ///< of all tracks
};

/// Frames in order of time. Matches are less than 2 m apart: first what matched before, then the
/// most pairs of the least sum of distances (CLEAR MOT).
BenchmarkFigures trackingBenchmark(const std::vector<BenchmarkFrame>& frames);

/// The class of the benchmark for a type of the truth; empty: none.
std::string benchmarkNameOf(const std::string& truth_type);
/// The same for a track, constant along it: by its class, those of class bus by their length, for
/// it holds trucks, too. Empty: none.
std::string benchmarkNameOf(const std::string& class_name, double length);

/// The name of each track of a run: of the class with the largest sum of probabilities, and its
/// mean length.
std::map<std::uint64_t, std::string> benchmarkNamesOf(const TrackedRun& run);

/// Of a run, for each class of which there is truth: frames with a number that the truth has; truth
/// within the benchmark's range from the vehicle (50 m, two-wheelers and pedestrians 40 m) and with
/// a lidar return, where counted; tracks within that range. A track's score is its existence.
std::vector<BenchmarkFigures> trackingBenchmark(const TrackedRun& run, const GroundTruth& truth,
                                                const AlignmentOptions& options);

}  // namespace perception
