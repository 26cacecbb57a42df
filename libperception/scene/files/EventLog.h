#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

/// kWarning: the run ends with exit code 3.
enum class Severity { kInfo, kWarning };

/// Event kinds written by the programs; any other string may be used, too.
namespace event_kind {
inline constexpr char kDroppedPoints[] = "dropped_points";  ///< NaN, infinite, negative, too far
inline constexpr char kDroppedMeasurements[] = "dropped_measurements";  ///< invalid covariance
inline constexpr char kDroppedFrame[] = "dropped_frame";  ///< no stamp, no image, cannot be decoded
inline constexpr char kOutOfOrder[] = "out_of_order";     ///< older than the reorder window
inline constexpr char kClockJump[] = "clock_jump";        ///< back: new epoch; forward: a gap
inline constexpr char kEgoGap[] = "ego_gap";              ///< no ego pose near an instant
inline constexpr char kEgoJump[] = "ego_jump";            ///< pose rejected by the jump gate
inline constexpr char kOutputSensor[] = "output_sensor";  ///< scenes at the scans of another one
inline constexpr char kSensorLost[] = "sensor_lost";
inline constexpr char kSensorBack[] = "sensor_back";
inline constexpr char kLearned[] = "learned";               ///< of detectors, as INI lines
inline constexpr char kSensorMissing[] = "sensor_missing";  ///< configured, not in the log
inline constexpr char kSensorIgnored[] = "sensor_ignored";  ///< in the log, not configured
inline constexpr char kLidarInputs[] = "lidar_inputs";      ///< fields that a lidar does not give
inline constexpr char kSensorBlind[] = "sensor_blind";      ///< frames with nothing in them
inline constexpr char kSensorFouled[] = "sensor_fouled";    ///< dirt on its window, misses much
inline constexpr char kSensorMisaligned[] = "sensor_misaligned";  ///< sees all off to one side
inline constexpr char kWeather[] = "weather";  ///< its type changed: clear, rain, snow, fog
inline constexpr char kPhantomsBegin[] = "phantoms_begin";  ///< many clusters are phantoms
inline constexpr char kPhantomsEnd[] = "phantoms_end";      ///< few are again
inline constexpr char kPhantoms[] = "phantoms";             ///< totals of the run, by lidar
inline constexpr char kLogDamaged[] = "log_damaged";    ///< torn, wrong check sum, unknown class
inline constexpr char kFilterReset[] = "filter_reset";  ///< weights or a state became not finite
inline constexpr char kTrackBorn[] = "track_born";      ///< first time in a scene
inline constexpr char kTrackConfirmed[] =
    "track_confirmed";                              ///< first time classified as a named class
inline constexpr char kTrackLost[] = "track_lost";  ///< left the scene for good
}  // namespace event_kind

/// Events of a run: events.jsonl, one JSON object per line:
///   {"t": 1.5, "stamp": "1700000001.500000000", "kind": "...", "severity": "info|warning",
///   "message": "...", "fields": {}}
/// t [s] since the log's first stamp, stamp [s] since 1970 as text (exact); both null for an event
/// without a stamp. Lines are in the order of add(), which is called from one thread in the order
/// of the log, but for hold().
class EventLog {
 public:
  using Fields = nlohmann::ordered_json;

  /// Memory is bounded: without a file the first `kept_per_kind` events of each kind are stored,
  /// the others only counted.
  explicit EventLog(std::size_t kept_per_kind = 100000) : kept_per_kind_(kept_per_kind) {}

  /// `fields`: an object of numbers and texts, {{"sensor", "LIDAR_TOP"}, {"points", 12}}.
  void add(std::optional<Stamp> stamp, const std::string& kind, const std::string& message,
           Fields fields = Fields::object(), Severity severity = Severity::kInfo);
  /// The same as a warning.
  void warn(std::optional<Stamp> stamp, const std::string& kind, const std::string& message,
            Fields fields = Fields::object());

  /// Told of each event from now on, on the thread of add(): its stamp and its line of events.jsonl
  /// without t and stamp.
  using Listener = std::function<void(std::optional<Stamp>, const nlohmann::ordered_json&)>;
  void tell(Listener listener) { listener_ = std::move(listener); }

  /// Something is late: the events from now on wait for release(), each time that this is called
  /// for one release() more.
  void hold() { held_.emplace_back(); }
  /// Calls `late`, whose events come first, and then writes those that waited for it. Without a
  /// hold() only the former.
  void release(const std::function<void()>& late);

  /// Number of events by kind, including those not stored.
  const std::map<std::string, std::uint64_t>& counts() const { return counts_; }
  std::uint64_t warnings() const { return warnings_; }
  static constexpr std::size_t kFirst = 3;
  /// The messages of the first kFirst warnings with different ones.
  const std::vector<std::string>& firstWarnings() const { return first_warnings_; }

  /// The stored events as lines; a last line per truncated kind gives the number of omitted events.
  std::string text(Stamp first_stamp) const;
  /// Writes the stored events now and all later ones at once; from then on none is stored or
  /// omitted. Throws OutputError, as add() does from then on.
  void writeTo(const std::string& path, Stamp first_stamp);
  bool isWritten() const { return file_.has_value(); }
  /// Completes the file of writeTo(). Throws OutputError.
  void close();

 private:
  struct Event {
    std::optional<Stamp> stamp;
    std::string kind, message;
    Fields fields;
    Severity severity;
  };
  void put(Event event);
  static nlohmann::ordered_json contentOf(const Event& event);
  static std::string lineOf(const Event& event, Stamp first_stamp);

  std::size_t kept_per_kind_;
  std::vector<Event> events_;
  bool lets_through_ = false;            ///< within release()
  std::deque<std::vector<Event>> held_;  ///< by hold(), oldest first
  std::optional<OutputFile> file_;
  Stamp first_stamp_;  ///< of the file
  std::map<std::string, std::uint64_t> counts_;
  std::map<std::string, std::uint64_t> stored_;  ///< or omitted, without a file; by kind
  std::uint64_t warnings_ = 0;
  std::vector<std::string> first_warnings_;
  Listener listener_;
};

}  // namespace perception
