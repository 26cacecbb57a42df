#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/sensors/satellites/PositionTrack.h"

namespace perception {
namespace {

constexpr const char* kObjectLabel = "GPS_OBJECT";
/// [m] Size of a point as a box, since front ends require sizes above 0; `sizes = false` ignores
/// them.
constexpr double kGpsPointSize = 0.1;

/// A receiver's track, NMEA or GPX: the way of the vehicle, or of an object beside a standing one.
class TrackImporter final : public Importer {
 public:
  explicit TrackImporter(bool nmea) : nmea_(nmea) {}
  void declare(CLI::App& cli) override {
    cli.add_option("--track", file_,
                   nmea_ ? "NMEA 0183 log with GGA sentences (.nmea, .txt, .log)"
                         : "GPX 1.1 track (.gpx), or CSV with t_s, lat_deg, lon_deg (.csv)")
        ->required();
    cli.add_flag("--as-object", as_object_,
                 "positions of an object, seen from a vehicle that stands at the first fix");
    cli.add_option("--date", date_, "of the first fix where the file has no date, as 2011-09-26")
        ->capture_default_str();
    cli.add_option("--sigma", sigma_, "[m] of a fix, each axis")
        ->check(CLI::Range(0.001, 1e3))
        ->capture_default_str();
  }
  void run(ImportLog& log) override;

 private:
  std::vector<GpsFix> read(ImportLog& log) const;

  bool nmea_, as_object_ = false;
  std::string file_, date_ = "2011-09-26";
  double sigma_ = 3;  ///< a civil receiver's
};

std::vector<GpsFix> TrackImporter::read(ImportLog& log) const {
  const PositionTrack track = readPositionTrack(file_);
  const auto day = stampOfDay(date_);
  if (!day) failUsage(fmt::format("--date '{}': expected a date as 2011-09-26", date_));
  if (track.fixes.empty()) throw DataError(file_ + ": no valid fix in it");
  if (track.dropped > 0)
    log.warn(fmt::format("{}: {} lines without a valid fix, or not later than the one before",
                         file_, track.dropped));
  // GPX counts from 1970, NMEA from midnight, CSV from anything.
  const bool dated = track.fixes.front().t > 86400.0 * 365;
  std::vector<GpsFix> fixes;
  for (const auto& fix : track.fixes) {
    const Stamp stamp = Stamp{dated ? 0 : day->ns} + fix.t;
    fixes.push_back({stamp, fix.latitude, fix.longitude, 0});
  }
  return fixes;
}

void TrackImporter::run(ImportLog& log) {
  const auto fixes = read(log);
  const auto poses = posesOfFixes(fixes);
  PoseUncertainty uncertainty{sigma_, 0, 0};
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const auto number = static_cast<std::int64_t>(i);
    if (!log.wants(number)) continue;
    const Stamp stamp = fixes[i].stamp;
    log.ego(stamp, as_object_ ? Pose3::Identity() : poses[i].pose,
            as_object_ ? PoseUncertainty{0, 0, 0} : uncertainty);
    log.frame(stamp, number);
    if (as_object_) {
      ObjectDetections found;
      ObjectDetection& object = found.objects.emplace_back();
      object.label = "object";
      object.score = 1;
      object.space_box = ObjectDetection::SpaceBox{poses[i].pose.translation(), 0, kGpsPointSize,
                                                   kGpsPointSize, kGpsPointSize};
      log.sensor(kObjectLabel, stamp, Pose3::Identity(), std::move(found));
    } else {
      log.observation(*gpsObservation(fixes[i]));
    }
    log.progress(number + 1, static_cast<std::int64_t>(fixes.size()));
  }
  if (!as_object_) log.note("poses: place by the fixes, heading by the course over ground");
}

}  // namespace

std::unique_ptr<Importer> makeNmeaImporter() { return std::make_unique<TrackImporter>(true); }
std::unique_ptr<Importer> makeGpxImporter() { return std::make_unique<TrackImporter>(false); }

}  // namespace perception
