#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libperception/simulation/recorded/WeatheredLog.h"

namespace perception {

/// Takes the labels of a scan (PointTruth.h) by its frame number.
using LabelSink = std::function<void(std::int64_t frame, const std::vector<std::uint32_t>& labels)>;
/// Told of each entry of a log: bytes read and lidar scans so far; may throw to end the work.
using RecordingStep = std::function<void(std::uint64_t bytes, std::uint64_t scans)>;

/// A recording that is to be altered.
struct RecordingTask {
  std::string input, output;  ///< rawlogs
  SimulatedWeatherParams weather;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: number of cores
};

/// What became of it.
struct AlteredRecording {
  WeatheredLog::Counts counts;
  std::string text;        ///< for people: that it is simulated, and how
  std::string truth_file;  ///< copied beside the output; empty: the input has none
  std::vector<std::string> warnings;
  std::uint64_t entries = 0, bytes = 0;  ///< of the output
  double duration = 0;                   ///< [s] of the log
};

/// Writes the recording in simulated weather, and its truth beside it. Labels of an earlier log of
/// this name are removed. Throws DataError, OutputError.
AlteredRecording alteredRecording(const RecordingTask& task, const LabelSink& write_labels,
                                  const RecordingStep& step);
/// The counts as lines for people.
std::string textOf(const WeatheredLog::Counts& counts);

}  // namespace perception
