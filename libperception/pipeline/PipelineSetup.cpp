#include "libperception/pipeline/PipelineSetup.h"

#include <algorithm>
#include <set>

#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/filter/update/LanePrior.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/radar/RadarFrontEnd.h"
#include "libperception/vision/VisionFrontEnd.h"

namespace perception {
namespace {

/// A set of modalities, as "C/H+R".
struct SensorSet {
  std::set<Modality> modalities;
  bool wide_headings = false;  ///< C/H: a baseline of [radecki2016]
};

std::string wideWord(const ModalityRow& m) { return std::string(1, letterOf(m.letter)) + "/H"; }

/// "C, C/H, L, R": elements of a set.
std::string sensorWords() {
  std::string words;
  for (const ModalityRow& m : modalities()) {
    words += (words.empty() ? "" : ", ") + std::string(1, letterOf(m.letter));
    if (m.wide_headings) words += ", " + wideWord(m);
  }
  return words;
}

/// Empty unless the text is sensorWords() joined by +.
std::optional<SensorSet> readSensorSet(const std::string& text) {
  SensorSet set;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    const std::string word = text.substr(at, end - at);
    const ModalityRow* m = word.empty() ? nullptr : findModality(word[0]);
    if (m == nullptr) return std::nullopt;
    const bool wide = m->wide_headings && word == wideWord(*m);
    if (word.size() > 1 && !wide) return std::nullopt;
    set.modalities.insert(m->letter);
    set.wide_headings = set.wide_headings || wide;
    at = end + 1;
  }
  return set;
}

std::shared_ptr<const FrontEnd> makeFrontEnd(Config& config, const std::string& section,
                                             const std::string& label,
                                             const DetectionParams& params,
                                             const PipelineSetup& s) {
  std::string known;
  for (const FrontEndRow& row : frontEnds()) {
    if (params.kind == row.kind) {
      std::unique_ptr<FrontEnd> front_end = row.make(config, label, s.model.classes);
      if (front_end) front_end->scaleNoiseBy(params.noise_scale);
      if (auto* lidar = dynamic_cast<LidarFrontEnd*>(front_end.get())) {
        lidar->reachAsFarAs([stop = s.stop](double speed) {
          return stoppingDistance(speed, 0, stop) + stop.margin;
        });
      }
      return front_end;
    }
    known += (known.empty() ? "" : ", ") + row.kind;
  }
  config.fault(section, "kind", "unknown front end '" + params.kind + "', known are: " + known);
  return nullptr;
}

void readFilter(Config& config, PipelineSetup& s) {
  s.model.classes = readClassTable(config);
  s.model.params = config.read<FilterParams>("filter");
  s.model.proposal = s.run.association;
  s.model.history = s.run.output_lag;
  const auto lanes = config.read<LaneParams>("lanes");
  if (!lanes.file.empty())
    s.model.lanes = std::make_shared<const LanePrior>(LaneMap::fromFile(lanes.file), lanes);
  s.particles = config.read<ParticleFilterParams>("particle_filter");
}

PipelineSetup::Sensor readSensor(Config& config, const std::string& section,
                                 const std::string& label, const PipelineSetup& s,
                                 const SensorSet& set) {
  PipelineSetup::Sensor sensor;
  sensor.label = label;
  sensor.params = config.read<DetectionParams>(section);
  const bool clouds = rowOf(sensor.params.modality).gives_ground;
  if (sensor.params.kind == "lidar") sensor.scan = config.read<ScanParams>(section);
  if (!sensor.scan.merge.empty() && sensor.scan.merge_window > s.run.reorder_window)
    config.fault(section, "merge_window", "must not be above [run] reorder_window");
  if (!sensor.scan.merge.empty() && sensor.params.pose)
    config.fault(section, "pose", "several scanners are merged: their poses come with the log");
  sensor.front_end = makeFrontEnd(config, section, label, sensor.params, s);
  const auto& without = s.run.without;
  const bool only_ground = sensor.scan.ground == ScanParams::Ground::kOnly;
  sensor.active = !only_ground && set.modalities.count(sensor.params.modality) > 0 &&
                  std::find(without.begin(), without.end(), label) == without.end();
  sensor.gives_ground =
      clouds && (only_ground || (sensor.active && sensor.scan.ground == ScanParams::Ground::kYes));
  return sensor;
}

void checkSensors(Config& config, const PipelineSetup& s) {
  for (const auto& label : s.run.without) {
    if (label == "none") continue;
    const auto is_it = [&](const auto& sensor) { return sensor.label == label; };
    if (std::none_of(s.sensors.begin(), s.sensors.end(), is_it))
      config.fault("run", "without", "there is no [sensor." + label + "]");
  }
  if (s.ego.source == EgoPoseParams::Source::kLidar &&
      std::none_of(s.sensors.begin(), s.sensors.end(),
                   [](const auto& sensor) { return sensor.isLidarInUse(); }))
    config.fault("ego", "source", "lidar: no lidar is in use");
  if (s.ego.source == EgoPoseParams::Source::kRadar &&
      std::none_of(s.sensors.begin(), s.sensors.end(),
                   [](const auto& sensor) { return sensor.isRadarInUse(); }))
    config.fault("ego", "source", "radar: no radar is in use");
  const auto active = [](const auto& sensor) { return sensor.active; };
  if (std::none_of(s.sensors.begin(), s.sensors.end(), active)) {
    config.fault("run", "sensors",
                 "no [sensor.LABEL] section has a modality of '" + s.run.sensors + "'");
  }
  const auto named = [&](const auto& sensor) {
    return sensor.label == s.run.output_sensor && sensor.active;
  };
  if (!s.run.output_sensor.empty() && std::none_of(s.sensors.begin(), s.sensors.end(), named)) {
    config.fault("run", "output_sensor", "'" + s.run.output_sensor + "' is not a sensor in use");
  }
}

}  // namespace

std::vector<FrontEndRow>& frontEnds() {
  static std::vector<FrontEndRow> rows = {{"lidar", &makeLidarFrontEnd},
                                          {"boxes", &makeVisionFrontEnd},
                                          {"radar", &makeRadarFrontEnd},
                                          {"positions", &makePositionFrontEnd}};
  return rows;
}

const std::vector<std::string>& RunParams::associationNames() {
  static const std::vector<std::string> names = {"sampled", "ranked", "nearest"};
  return names;
}

void RunParams::visit(ParamVisitor& v) {
  v.unsigned64("seed", seed, "of all random numbers; --seed wins");
  v.text("sensors", sensors,
         ("modalities in use: " + sensorWords() +
          " joined by + (/H: headings as one wide Gaussian); "
          "--sensors wins")
             .c_str());
  v.words("without", without, "labels of sensors to exclude from these; none");
  v.choiceOf(
      "association", association, associationNames(),
      "sampled: drawn from the optimal proposal; ranked: the k best assignments (MHT); nearest: "
      "the best one alone (global nearest neighbor)");
  v.text("output_sensor", output_sensor,
         "scenes at its scans; empty: the first lidar in use, else the first sensor");
  v.real("output_rate", output_rate, {0, 1000}, "Hz",
         "scenes at a fixed rate instead; 0: at scans; --rate wins");
  v.real("output_lag", output_lag, {0, 10}, "s",
         "scenes so much late, with what came after their instant; 0: at once");
  v.expert();
  v.real("reorder_window", reorder_window, {0, 10}, "s", "largest delay of an observation");
  v.boolean("write_measurements", write_measurements,
            "write the filter's input to measurements.csv, scans.csv and sensors.csv; "
            "--measurements wins");
}

PipelineSetup PipelineSetup::read(Config& config) {
  PipelineSetup s;
  s.run = config.read<RunParams>("run");
  readFilter(config, s);
  s.scene = config.read<SceneParams>("scene");
  s.ego = config.read<EgoPoseParams>("ego");
  s.ground = config.read<GroundParams>("ground");
  s.weather = WeatherParams::read(config);
  s.grid = config.read<GridParams>("grid");
  s.stop = config.read<StopParams>("grid.stop");
  s.stop.vehicle = config.read<VehicleParams>("vehicle");
  const auto set = readSensorSet(s.run.sensors);
  if (!set) {
    config.fault(
        "run", "sensors",
        "'" + s.run.sensors + "' is not a list of " + sensorWords() + " joined by + (as C+L)");
  }
  const SensorSet used = set.value_or(SensorSet{});
  const auto covers = [](Modality m) { return rowOf(m).covers_sector; };
  if (std::none_of(used.modalities.begin(), used.modalities.end(), covers))
    s.scene.place_within = 0;  // see SceneParams
  if (used.wide_headings) s.model.params.heading = HeadingMode::kWide;
  const std::string prefix = "sensor.";
  for (const auto& section : config.sectionsWithPrefix(prefix)) {
    const std::string label = section.substr(prefix.size());
    if (label.find('.') != std::string::npos) continue;  // a table of that sensor
    s.sensors.push_back(readSensor(config, section, label, s, used));
  }
  checkSensors(config, s);
  return s;
}

PipelineSetup PipelineSetup::fromFile(const std::string& ini,
                                      const std::vector<std::string>& settings) {
  Config config = Config::fromFile(ini);
  for (const std::string& setting : settings) config.set(setting);
  PipelineSetup setup = read(config);
  config.finish();
  return setup;
}

std::optional<std::size_t> PipelineSetup::sensorOf(const std::string& label) const {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].label == label || sensors[i].scan.merges(label)) return i;
  }
  return std::nullopt;
}

}  // namespace perception
