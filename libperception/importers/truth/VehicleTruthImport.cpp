#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <deque>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/truth/SecondVehicle.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/satellites/GnssFix.h"
#include "libperception/sensors/satellites/PositionTrack.h"

namespace perception {
namespace {

constexpr double kSettled = 1;         ///< [s] after which no pose of an instant comes any more
constexpr double kSame = 1e-3;         ///< [s] stamps of one instant
constexpr double kDay = 86400;         ///< [s]
constexpr double kDated = 365 * kDay;  ///< [s] times above count from 1970

/// What a log says of the vehicle that recorded it.
struct OwnVehicle {
  Stamp first;  ///< of the log
  std::vector<FramePose> poses;
  std::vector<GnssFix> fixes;
  std::uint64_t frames_lost = 0;  ///< without a pose near, or before the world frame changed
};

/// Poses at the log's frames, in the world frame of runs with this [ego]; without frame
/// numbers, at its scans.
class OwnVehicleReader {
 public:
  explicit OwnVehicleReader(const EgoPoseParams& params)
      : gnss_(params.fusion.gnss), ego_(params) {}

  OwnVehicle read(const std::string& path) {
    RawlogReader reader(path);
    while (const auto observation = reader.next()) add(*observation);
    if (!reader.isComplete()) throw DataError(reader.endMessage());
    settle(Stamp{INT64_MAX});
    if (out_.poses.empty())
      throw DataError(path +
                      ": no frame with a pose of the vehicle: [ego] source needs poses, GNSS "
                      "or wheels");
    return std::move(out_);
  }

 private:
  struct Instant {
    Stamp stamp;
    std::int64_t frame = -1;
  };

  void add(const mrpt::obs::CObservation& observation) {
    const auto stamp = toStamp(observation.timestamp);
    if (!stamp) return;
    if (out_.first.ns == 0) out_.first = *stamp;
    ego_.add(observation);
    if (const auto number = frameNumber(observation)) {
      if (!numbered_) waiting_.clear();
      numbered_ = true;
      waiting_.push_back(Instant{*stamp, *number});
    } else if (!numbered_ && isSensorData(observation) &&
               (waiting_.empty() || std::abs(*stamp - waiting_.back().stamp) > kSame)) {
      waiting_.push_back(Instant{*stamp, -1});
    }
    if (const auto* gps = dynamic_cast<const mrpt::obs::CObservationGPS*>(&observation)) {
      if (const auto fix = gnssFix(*gps, gnss_)) out_.fixes.push_back(*fix);
    }
    settle(*stamp + -kSettled);
  }

  void settle(Stamp until) {
    for (; !waiting_.empty() && waiting_.front().stamp < until; waiting_.pop_front()) {
      const Instant& instant = waiting_.front();
      const auto state = ego_.at(instant.stamp);
      if (ego_.frameEpoch() != epoch_) {
        epoch_ = ego_.frameEpoch();
        out_.frames_lost += out_.poses.size();
        out_.poses.clear();
      }
      if (state)
        out_.poses.push_back({instant.stamp, instant.frame, state->T_world_ego});
      else
        ++out_.frames_lost;
    }
  }

  GnssParams gnss_;
  EgoPose ego_;
  std::uint64_t epoch_ = 0;
  bool numbered_ = false;
  std::deque<Instant> waiting_;
  OwnVehicle out_;
};

/// Fixes of the other vehicle: from its own rawlog, or a receiver's file.
class OtherFixes {
 public:
  OtherFixes(std::string path, double offset, double sigma)
      : path_(std::move(path)), offset_(offset), sigma_(sigma) {}

  std::vector<GnssFix> read(Stamp log_start) const {
    const std::string ending = ".rawlog";
    const bool is_log = path_.size() > ending.size() &&
                        path_.compare(path_.size() - ending.size(), ending.size(), ending) == 0;
    std::vector<GnssFix> fixes = is_log ? ofLog() : ofTrack(log_start);
    if (fixes.empty()) throw DataError(path_ + ": no valid fix in it");
    for (GnssFix& fix : fixes) fix.stamp = fix.stamp + offset_;
    return fixes;
  }

 private:
  std::vector<GnssFix> ofLog() const {
    std::vector<GnssFix> fixes;
    RawlogReader reader(path_);
    while (const auto observation = reader.next()) {
      const auto* gps = dynamic_cast<const mrpt::obs::CObservationGPS*>(observation.get());
      if (gps == nullptr) continue;
      if (const auto fix = gnssFix(*gps, {})) fixes.push_back(*fix);
    }
    if (!reader.isComplete()) throw DataError(reader.endMessage());
    return fixes;
  }

  /// Times of a file without a date are those of the day nearest to the log's beginning.
  std::vector<GnssFix> ofTrack(Stamp log_start) const {
    const PositionTrack track = readPositionTrack(path_);
    std::vector<GnssFix> fixes;
    if (track.fixes.empty()) return fixes;
    std::int64_t day_ns = 0;
    if (track.fixes.front().t < kDated) {
      const double since_1970 = static_cast<double>(log_start.ns) * 1e-9;
      const double days = std::round((since_1970 - track.fixes.front().t) / kDay);
      day_ns = static_cast<std::int64_t>(days) * static_cast<std::int64_t>(kDay) * 1'000'000'000;
    }
    for (const PositionTrack::Fix& f : track.fixes) {
      GnssFix fix;
      fix.stamp = Stamp{day_ns} + f.t;
      fix.place = {f.latitude, f.longitude, 0};
      fix.sigma = sigma_;
      fixes.push_back(fix);
    }
    return fixes;
  }

  std::string path_;
  double offset_, sigma_;
};

/// Another vehicle's GNSS or INS log as the truth of a log.
class VehicleTruthImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--log", log_, "rawlog whose truth it becomes, with the own poses and GNSS")
        ->required();
    cli.add_option("--track", track_,
                   "the other vehicle's receiver: .nmea .txt .log (GGA), .gpx, .csv (t_s, lat_deg, "
                   "lon_deg), .rawlog")
        ->required();
    cli.add_option("-c,--config", config_, "INI of the log's runs, for its [ego]");
    cli.add_option("--id", vehicle_.id, "of the object in the truth")->capture_default_str();
    cli.add_option("--type", vehicle_.type, "class as in KITTI")->capture_default_str();
    cli.add_option("--size", size_, "[m] length, width, height")->expected(3);
    cli.add_option("--antenna", antenna_, "[m] ahead and to the left of its footprint's center")
        ->expected(2);
    cli.add_option("--time-offset", offset_,
                   "[s] added to its times, as -18 for GPS time (2017 and later)");
    cli.add_option("--sigma", sigma_, "[m] of a fix, each axis, where the file does not tell")
        ->check(CLI::Range(0.001, 1e3))
        ->capture_default_str();
  }

  void run(ImportLog&) override {}
  bool runInstead(const std::string& output) override;

 private:
  EgoPoseParams egoParams() const {
    if (config_.empty()) return {};
    Config config = Config::fromFile(config_);
    const auto params = config.read<EgoPoseParams>("ego");
    if (params.isOdometry())
      throw ConfigError(config_ + ": [ego] source: the truth needs poses of the log or GNSS");
    return params;
  }

  std::string log_, track_, config_;
  OtherVehicle vehicle_;
  std::vector<double> size_, antenna_;
  double offset_ = 0, sigma_ = GnssParams().sigma;
};

std::vector<PlaceFix> placesOf(const std::vector<GnssFix>& fixes, const LocalFrame& frame) {
  std::vector<PlaceFix> places;
  for (const GnssFix& fix : fixes) {
    Geodetic place = fix.place;
    place.height = frame.origin().height;  // the map is flat
    places.push_back({fix.stamp, frame.fromGeodetic(place).head<2>(), fix.sigma});
  }
  return places;
}

bool VehicleTruthImporter::runInstead(const std::string& output) {
  if (output.empty())
    failUsage("-o: expected the truth to be written, FILE.truth.csv beside FILE.rawlog");
  if (!size_.empty()) {
    vehicle_.length = size_[0], vehicle_.width = size_[1], vehicle_.height = size_[2];
    for (const double s : size_)
      if (!(s > 0 && s < 100)) failUsage("--size: three lengths of 0 to 100 m expected");
  }
  if (!antenna_.empty()) vehicle_.antenna = {antenna_[0], antenna_[1]};
  const OwnVehicle own = OwnVehicleReader(egoParams()).read(log_);
  if (own.fixes.empty())
    throw DataError(log_ + ": no GNSS of the own vehicle: its world frame has no place on Earth");
  const std::vector<GnssFix> other = OtherFixes(track_, offset_, sigma_).read(own.first);
  const LocalFrame frame(own.fixes.front().place);
  const auto alignment =
      alignToWorld(placesOf(own.fixes, frame), own.fixes.front().antenna.head<2>(), own.poses);
  const auto rows =
      truthOfVehicle(placesOf(other, frame), alignment, vehicle_, own.poses, own.first);
  if (rows.empty())
    throw DataError(fmt::format(
        "{}: no fix within 2 s of a frame of {}: its times run from {:.1f} to {:.1f} s of the log "
        "(--time-offset)",
        track_, log_, other.front().stamp - own.first, other.back().stamp - own.first));
  writeGroundTruth(output, rows);
  double sigma = 0;
  for (const GnssFix& fix : other) sigma += fix.sigma / static_cast<double>(other.size());
  fmt::print("{}: {} rows of {} frames, one object\n", output, rows.size(), own.poses.size());
  fmt::print("  own way and own GNSS: {} fixes, {:.2f} m rms apart, north known to {:.2f} deg\n",
             alignment.used, alignment.rms, degrees(alignment.sigma_yaw));
  fmt::print(
      "  its fixes: {}, each {:.2f} m (each axis); the truth cannot be better than what they "
      "have in common over seconds\n",
      other.size(), sigma);
  if (own.frames_lost > 0)
    fmt::print("  {} frames without a pose of the own vehicle have no truth\n", own.frames_lost);
  return true;
}

}  // namespace

std::unique_ptr<Importer> makeVehicleTruthImporter() {
  return std::make_unique<VehicleTruthImporter>();
}

}  // namespace perception
