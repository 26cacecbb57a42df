#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"

namespace perception {
namespace {

constexpr const char* kLaserLabel = "LASER";
constexpr const char* kUdacityRadar = "RADAR";
/// [m] Size of a point as a box, since front ends require sizes above 0; `sizes = false` ignores
/// them.
constexpr double kRadarPointSize = 0.1;
/// [m/s] speed below which the velocity does not determine a heading.
constexpr double kHeadingSpeed = 0.1;

/// One line: L x y t or R range bearing rate t [us], then truth x y vx vy [yaw yaw_rate].
class UdacityImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--measurements", file_, "text file of lines L ... and R ...")->required();
    cli.add_option("--type", type_, "class of the object in the truth")->capture_default_str();
  }
  void run(ImportLog& log) override;

 private:
  void write(const TextRow& row, std::int64_t number, ImportLog& log) const;
  TruthObject truth(const TextRow& row, std::size_t first) const;

  std::string file_, type_ = "Cyclist";  // Udacity's exercise calls it a bicycle
};

TruthObject UdacityImporter::truth(const TextRow& row, std::size_t first) const {
  TruthObject o;
  o.id = 0;
  o.type = type_;
  o.position = {row.real(first), row.real(first + 1), 0};
  o.vx = row.real(first + 2);
  o.vy = row.real(first + 3);
  o.length = o.width = o.height = std::numeric_limits<double>::quiet_NaN();
  if (row.size() > first + 4) {
    o.yaw = wrapAngle(row.real(first + 4));
  } else if (std::hypot(o.vx, o.vy) > kHeadingSpeed) {
    o.yaw = std::atan2(o.vy, o.vx);
  } else {
    o.yaw = std::numeric_limits<double>::quiet_NaN();
  }
  return o;
}

void UdacityImporter::write(const TextRow& row, std::int64_t number, ImportLog& log) const {
  const bool laser = row.text(0) == "L";
  if (!laser && row.text(0) != "R") row.fail(0, "L or R");
  const std::size_t time = laser ? 3 : 4, first = time + 1;
  row.expect(row.size() == first + 4 || row.size() == first + 6,
             laser ? "8 or 10: L x y t, truth x y vx vy [yaw yaw_rate]"
                   : "9 or 11: R range bearing rate t, truth x y vx vy [yaw yaw_rate]");
  const double microseconds = row.real(time);
  if (!(microseconds > 0) || microseconds != std::floor(microseconds) || microseconds > 4e15)
    row.fail(time, "microseconds since 1970");
  const Stamp stamp{static_cast<std::int64_t>(microseconds) * 1000};
  log.ego(stamp, Pose3::Identity());
  log.frame(stamp, number);
  if (laser) {
    ObjectDetections found;
    ObjectDetection& object = found.objects.emplace_back();
    object.label = "object";
    object.score = 1;
    object.space_box = ObjectDetection::SpaceBox{Vector3(row.real(1), row.real(2), 0), 0,
                                                 kRadarPointSize, kRadarPointSize, kRadarPointSize};
    log.sensor(kLaserLabel, stamp, Pose3::Identity(), std::move(found));
  } else {
    RadarReturns returns;
    RadarReturn& r = returns.returns.emplace_back();
    r.range = row.real(1);
    r.bearing = wrapAngle(row.real(2));
    r.range_rate = row.real(3);
    log.sensor(kUdacityRadar, stamp, Pose3::Identity(), std::move(returns));
  }
  TruthObject object = truth(row, first);
  object.frame = number;
  log.truth(stamp, std::move(object));
}

void UdacityImporter::run(ImportLog& log) {
  std::int64_t number = 0;
  forEachRow(file_, kSpaces, [&](const TextRow& row) {
    if (log.wants(number)) write(row, number, log);
    ++number;
  });
  if (number == 0) throw DataError(file_ + ": no line in it");
  log.note("simulated: measurements and truth are Udacity's");
}

}  // namespace

std::unique_ptr<Importer> makeUdacityImporter() { return std::make_unique<UdacityImporter>(); }

}  // namespace perception
