#include "libperception/scene/files/MeasurementRun.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/measurement/models/MeasurementModel.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr double kProbeStep = 0.25;  // [m]

constexpr const char* kSensorsHeader =
    "sensor,modality,fov,range_min,range_max,labels,class,class_range\n";
constexpr const char* kScansHeader =
    "sensor,frame,t,stamp,ego_x,ego_y,ego_z,ego_yaw,x,y,z,yaw,dropped,measurements\n";
constexpr const char* kMeasurementsHeader =
    "sensor,frame,t,stamp,label,x,y,range,bearing,sd_range,sd_across,score,length,width,height\n";

std::string meters(double value) {
  return std::isfinite(value) ? fixedPlaces(value, kMeterPlaces) : "";
}
std::string angle(double value) { return fixedPlaces(value, kRadianPlaces); }

// P_D of a small object of the class at `range` [m] ahead of the sensor.
double detectionAhead(const MeasurementScan& scan, ClassId c, double range) {
  const double yaw = yawOf(scan.state.T_world_sensor);
  const Vector2 place = scan.state.T_world_sensor.translation().head<2>() +
                        range * Vector2(std::cos(yaw), std::sin(yaw));
  Kinematics object;
  object.q.head<2>() = place;
  const Extent extent{0.5, 0.5, 1, 1};
  return scan.model->detectionProbability(c, object, extent, scan.state, 1);
}

double classRange(const MeasurementScan& scan, ClassId c, double range_min, double range_max) {
  double highest = 0;
  std::vector<double> p;
  for (double r = range_min + kProbeStep; r <= range_max; r += kProbeStep) {
    p.push_back(detectionAhead(scan, c, r));
    highest = std::max(highest, p.back());
  }
  for (std::size_t i = p.size(); i-- > 0;) {
    if (highest > 0 && p[i] >= 0.5 * highest)
      return i + 2 >= p.size() ? range_max : range_min + static_cast<double>(i + 1) * kProbeStep;
  }
  return 0;
}

// Standard deviations of a measurement along and across the line of sight [m]: from a range and
// bearings where the model has such axes, else the rough one.
void fillDeviations(const MeasurementScan& scan, const Measurement& m, RecordedMeasurement& out) {
  out.sd_range = out.sd_across = m.position_sigma;
  const auto& axes = scan.model->axes();
  if (std::find(axes.begin(), axes.end(), AxisKind::kAngle) == axes.end()) return;
  bool has_range = false, has_bearing = false;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!(m.seen >> i & 1)) continue;
    const double sd = std::sqrt(std::max(0.0, m.R(k, k)));
    if (axes[i] == AxisKind::kLinear && !has_range) {
      out.sd_range = sd;
      has_range = true;  // the first linear axis; a range rate comes after it
    } else if (axes[i] == AxisKind::kAngle) {
      out.sd_across = has_bearing ? std::min(out.sd_across, sd * out.range) : sd * out.range;
      has_bearing = true;
    }
  }
}

std::int64_t nanoseconds(const CsvTable& table, std::size_t row, const char* column) {
  std::int64_t ns = 0;
  const auto c = table.column(column);
  if (!parseDecimalSeconds(table.text(row, c), ns))
    table.fault(row, c, "seconds with at most nine decimal places");
  return ns;
}

Modality modalityOf(const CsvTable& table, std::size_t row) {
  const auto c = table.column("modality");
  const auto text = table.text(row, c);
  const ModalityRow* m = text.size() == 1 ? findModality(text[0]) : nullptr;
  if (m == nullptr) table.fault(row, c, "one of " + modalityLetters());
  return m->letter;
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const auto bar = text.find('|');
    parts.emplace_back(text.substr(0, bar));
    text = bar == std::string_view::npos ? std::string_view() : text.substr(bar + 1);
  }
  return parts;
}

void readSensors(const CsvTable& table, MeasurementRun& run) {
  const auto sensor = table.column("sensor"), name = table.column("class");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (run.sensors.empty() || run.sensors.back().label != table.text(row, sensor)) {
      RecordedSensor s;
      s.label = table.text(row, sensor);
      s.modality = modalityOf(table, row);
      s.fov = table.real(row, table.column("fov"));
      s.range_min = table.real(row, table.column("range_min"));
      s.range_max = table.real(row, table.column("range_max"));
      s.labels = split(table.text(row, table.column("labels")));
      run.sensors.push_back(std::move(s));
    }
    RecordedSensor& s = run.sensors.back();
    if (run.sensors.size() == 1) run.class_names.emplace_back(table.text(row, name));
    if (s.class_range.size() >= run.class_names.size() ||
        run.class_names[s.class_range.size()] != table.text(row, name)) {
      table.fault(row, name, "the classes of the first sensor in their order");
    }
    s.class_range.push_back(table.real(row, table.column("class_range")));
  }
}

RecordedMeasurement readMeasurement(const CsvTable& table, std::size_t row) {
  const auto real = [&](const char* column) { return table.real(row, table.column(column)); };
  const auto maybe = [&](const char* column) { return table.realOrNan(row, table.column(column)); };
  RecordedMeasurement m;
  m.label = table.text(row, table.column("label"));
  m.position = {real("x"), real("y")};
  m.range = real("range"), m.bearing = real("bearing");
  m.sd_range = real("sd_range"), m.sd_across = real("sd_across");
  m.score = real("score");
  m.length = maybe("length"), m.width = maybe("width"), m.height = maybe("height");
  return m;
}

RecordedScan readScan(const CsvTable& table, std::size_t row) {
  const auto real = [&](const char* column) { return table.real(row, table.column(column)); };
  RecordedScan scan;
  scan.frame = table.integer(row, table.column("frame"));
  scan.stamp.ns = nanoseconds(table, row, "stamp");
  scan.T_world_ego = makePose(real("ego_x"), real("ego_y"), real("ego_z"), real("ego_yaw"));
  scan.T_world_sensor = makePose(real("x"), real("y"), real("z"), real("yaw"));
  scan.dropped = table.natural(row, table.column("dropped"));
  return scan;
}

}  // namespace

RecordedSensor describeSensor(const MeasurementScan& scan, std::vector<std::string> labels,
                              double fov, double range_min, double range_max, int classes) {
  RecordedSensor sensor;
  sensor.label = scan.sensor;
  sensor.modality = scan.modality;
  sensor.fov = fov;
  sensor.range_min = range_min, sensor.range_max = range_max;
  sensor.labels = std::move(labels);
  for (ClassId c = 0; c < classes; ++c)
    sensor.class_range.push_back(classRange(scan, c, range_min, range_max));
  return sensor;
}

RecordedScan recordScan(const MeasurementScan& scan, const RecordedSensor& sensor) {
  RecordedScan out;
  out.frame = scan.frame;
  out.stamp = scan.state.stamp;
  out.T_world_ego = scan.state.ego.T_world_ego;
  out.T_world_sensor = scan.state.T_world_sensor;
  out.dropped = scan.dropped;
  const Vector2 origin = out.T_world_sensor.translation().head<2>();
  const double forward = yawOf(out.T_world_sensor);
  for (const Measurement& m : scan.measurements) {
    RecordedMeasurement r;
    const auto label = static_cast<std::size_t>(m.label);
    r.label = label < sensor.labels.size() ? sensor.labels[label] : "-";
    r.position = m.position;
    const Vector2 sight = m.position - origin;
    r.range = sight.norm();
    r.bearing = wrapAngle(std::atan2(sight.y(), sight.x()) - forward);
    fillDeviations(scan, m, r);
    r.score = m.log_score_ratio;
    if (m.sides) r.length = m.sides->length, r.width = m.sides->width;
    if (m.height) r.height = m.height->mean;
    const bool finite = r.position.allFinite() && std::isfinite(r.sd_range + r.sd_across + r.score);
    if (finite) {
      out.measurements.push_back(std::move(r));
    } else {
      ++out.dropped;
    }
  }
  return out;
}

MeasurementRunWriter::MeasurementRunWriter(const std::string& dir, const ClassTable& classes)
    : sensors_(dir + "/sensors.csv"),
      scans_(dir + "/scans.csv"),
      measurements_(dir + "/measurements.csv"),
      classes_(classes) {
  sensors_.write(kSensorsHeader);
  scans_.write(kScansHeader);
  measurements_.write(kMeasurementsHeader);
}

void MeasurementRunWriter::writeSensor(const RecordedSensor& s) {
  for (std::size_t c = 0; c < s.class_range.size(); ++c) {
    sensors_.write(fmt::format("{},{},{},{},{},{},{},{}\n", s.label, letterOf(s.modality),
                               angle(s.fov), meters(s.range_min), meters(s.range_max),
                               fmt::join(s.labels, "|"), classes_[static_cast<ClassId>(c)].name,
                               meters(s.class_range[c])));
  }
}

void MeasurementRunWriter::write(const RecordedScan& scan, const RecordedSensor& sensor,
                                 Stamp first_stamp) {
  const std::string instant =
      fmt::format("{},{},{},{}", sensor.label, scan.frame,
                  decimalSeconds(scan.stamp.ns - first_stamp.ns), decimalSeconds(scan.stamp.ns));
  const Vector3 ego = scan.T_world_ego.translation(), at = scan.T_world_sensor.translation();
  scans_.write(fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{}\n", instant, meters(ego.x()), meters(ego.y()),
      meters(ego.z()), angle(yawOf(scan.T_world_ego)), meters(at.x()), meters(at.y()),
      meters(at.z()), angle(yawOf(scan.T_world_sensor)), scan.dropped, scan.measurements.size()));
  for (const RecordedMeasurement& m : scan.measurements) {
    measurements_.write(fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", instant, m.label,
                                    meters(m.position.x()), meters(m.position.y()), meters(m.range),
                                    angle(m.bearing), meters(m.sd_range), meters(m.sd_across),
                                    fixedPlaces(m.score, kMeterPlaces), meters(m.length),
                                    meters(m.width), meters(m.height)));
  }
}

void MeasurementRunWriter::close() {
  sensors_.close();
  scans_.close();
  measurements_.close();
}

MeasurementRun readMeasurementRun(const std::string& dir) {
  const CsvTable sensors = CsvTable::fromFile(dir + "/sensors.csv");
  const CsvTable scans = CsvTable::fromFile(dir + "/scans.csv");
  const CsvTable measurements = CsvTable::fromFile(dir + "/measurements.csv");
  MeasurementRun run;
  run.dir = dir;
  readSensors(sensors, run);
  std::map<std::string, std::size_t, std::less<>> index;
  for (std::size_t i = 0; i < run.sensors.size(); ++i) index[run.sensors[i].label] = i;

  std::size_t next = 0;  // line of measurements.csv: they stand in the order of the scans
  const auto sensor = scans.column("sensor"), of = measurements.column("sensor");
  for (std::size_t row = 0; row < scans.rows(); ++row) {
    RecordedScan scan = readScan(scans, row);
    const auto found = index.find(scans.text(row, sensor));
    if (found == index.end()) scans.fault(row, sensor, "a sensor of sensors.csv");
    scan.sensor = found->second;
    if (row == 0) run.first_stamp.ns = scan.stamp.ns - nanoseconds(scans, row, "t");
    const auto count = scans.column("measurements");
    for (std::uint64_t i = 0; i < scans.natural(row, count); ++i, ++next) {
      const bool fits = next < measurements.rows() &&
                        measurements.text(next, of) == scans.text(row, sensor) &&
                        nanoseconds(measurements, next, "stamp") == scan.stamp.ns;
      if (!fits) scans.fault(row, count, "as many lines in measurements.csv");
      scan.measurements.push_back(readMeasurement(measurements, next));
    }
    run.scans.push_back(std::move(scan));
  }
  if (next != measurements.rows())
    measurements.fault(next, of, "a scan in scans.csv that it belongs to");
  return run;
}

}  // namespace perception
