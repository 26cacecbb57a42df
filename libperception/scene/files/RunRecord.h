#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"

namespace perception {

/// Statistics of one sensor in a run.
struct SensorRecord {
  std::string label;
  std::string modality;      ///< its letter: "C", "L", "R"
  std::uint64_t frames = 0;  ///< processed
  std::uint64_t measurements = 0;
  std::uint64_t dropped_points = 0;  ///< not finite, out of range
  std::uint64_t dropped_measurements =
      0;  ///< detections rejected by the front end: no label, no box, ghost ...
  std::uint64_t dropped_frames = 0;  ///< no stamp, cannot be decoded, older than the reorder window
};

/// done.json: inputs and outcome of a run. Written last: a folder that has it is complete. A
/// function of (rawlog, INI, seed) like all results: no time of day, no run times, no folder names.
struct RunRecord {
  std::string program;  ///< "perception-track"
  std::string version;
  std::string hash;   ///< hashOfRun(): of log, effective INI and version
  std::string input;  ///< file name of the log; folders are removed when written
  std::uint64_t input_bytes = 0;
  std::uint64_t input_entries = 0;  ///< objects read from the log
  std::string input_end =
      "clean";  ///< end of the log: clean, torn (truncated), unknown class, newer version, damaged
  std::string input_end_detail;  ///< position and reason; empty if clean
  bool input_verifiable = true;  ///< a clean end proves that nothing is missing
  bool simulated = false;        ///< the log is marked as simulated
  /// Of a simulated log, as its first comment says it ("rain 10 mm/h", "" in clear air); else
  /// unknown.
  std::optional<std::string> weather;
  std::string config;  ///< file name of the INI
  std::uint64_t seed = 0;
  std::string sensors_used;  ///< as given with --sensors
  std::string association;
  int particles = 0;
  Stamp first_stamp, last_stamp;  ///< of the log
  std::uint64_t scenes = 0;
  std::uint64_t tracks = 0;                     ///< different ids in tracks.csv
  std::vector<SensorRecord> sensors;            ///< in the order of the INI
  std::map<std::string, std::uint64_t> events;  ///< EventLog::counts()
  std::vector<std::string> warnings;            ///< in order of appearance
};

/// The text of done.json: keys in the order above, the same bytes for the same record.
std::string toJson(const RunRecord& record);
/// Throws OutputError.
void writeRunRecord(const std::string& path, const RunRecord& record);
/// Throws DataError with path and what is missing or wrong (kNoInput when there is no such file).
RunRecord readRunRecord(const std::string& path);

}  // namespace perception
