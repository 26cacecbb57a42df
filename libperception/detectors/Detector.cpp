#include "libperception/detectors/Detector.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr const char* kModelPrefix = "model.";

#ifdef PERCEPTION_DPM
constexpr auto kMakeDpm = &makeDpmDetector;
#else
constexpr std::unique_ptr<Detector> (*kMakeDpm)(const DetectorSetup&) = nullptr;
#endif
constexpr const char* kNotBuilt = " is not in this build (cmake -DPERCEPTION_DPM=ON)";

std::unique_ptr<Detector> makeNothing(const DetectorSetup&) { return nullptr; }

double valueOf(const std::vector<std::pair<std::string, double>>& table, const std::string& name,
               double otherwise) {
  for (const auto& [key, value] : table) {
    if (key == name) return value;
  }
  return otherwise;
}

}  // namespace

void DetectorModelParams::visit(ParamVisitor& v) {
  v.text("file", file, "of the model, relative to [detector] folder");
  v.text("label", label, "class name of its boxes; empty: the model's own");
  v.words("names", names, "networks: INDEX=LABEL of the classes to report (COCO: 2=Car)");
  v.real("threshold", threshold, {-1e9, 1e9}, "score", "weaker boxes are dropped");
  v.real("low", low, {0.1, 20}, "m", "height of the smallest objects");
  v.real("high", high, {0.1, 20}, "m", "height of the tallest objects");
  v.require(low < high, "low: must be below high");
  v.real("slope", slope, {0, 1e3}, "1/score",
         "P(object | score) = 1 / (1 + exp(-slope (score - even_score))); 0: not calibrated");
  v.real("even_score", even_score, {-1e9, 1e9}, "score", "score at which P(object) is one half");
  v.table("slope.", label_slope, {0, 1e3}, "1/score", "the same for one label");
  v.table("even_score.", label_even_score, {-1e9, 1e9}, "score", "the same for one label");
}

double DetectorModelParams::slopeOf(const std::string& name) const {
  return valueOf(label_slope, name, slope);
}

double DetectorModelParams::evenScoreOf(const std::string& name) const {
  return valueOf(label_even_score, name, even_score);
}

void DpmParams::visit(ParamVisitor& v) {
  v.integer("levels_per_octave", options.levels_per_octave, {1, 20},
            "pyramid levels per octave (voc-release: 10)");
  v.real("enlarge", options.enlarge, {1, 4}, "",
         "scale of the first pyramid level: 2 finds cars of 16 to 20 px");
  v.real("outside", options.outside, {0, 1}, "",
         "share of an object's sides that may lie beyond the image");
  v.integer("window", options.window, {0, 12}, "largest displacement of a part in its cells");
  v.real("overlap", options.overlap, {0, 1}, "", "share of the weaker box inside the better one");
}

const std::vector<std::string>& OnnxParams::layoutNames() {
  static const std::vector<std::string> names{"auto", "yolox", "yolov5", "yolov8"};
  return names;
}

void OnnxParams::visit(ParamVisitor& v) {
  v.integer("input", input, {32, 4096}, "side of the network's square input in pixels");
  v.choice("layout", layout, layoutNames(), "of the output; auto: by its shape");
  v.real("overlap", overlap, {0, 1}, "", "intersection over union of boxes of one object");
  v.boolean("windows", windows,
            "search long images also in overlapping square windows of their shorter side");
  v.real("window_overlap", window_overlap, {0, 0.9}, "",
         "overlap of neighboring windows, share of their side");
}

void HogParams::visit(ParamVisitor& v) {
  v.real("enlarge", enlarge, {0.5, 4}, "",
         "scale of the image: the smallest people detected have 96 px");
  v.real("overlap", overlap, {0, 1}, "", "intersection over union of boxes of one object");
}

void DetectorSetup::visit(ParamVisitor& v) {
  std::vector<std::string> names;
  for (const auto& row : detectorBackends()) names.emplace_back(row.name);
  v.choice("backend", backend, names, "detector; file: the boxes in the log");
  v.path("folder", folder,
         "of the models' files; what is not there is looked for in the environment's "
         "PERCEPTION_MODELS");
  v.boolean("ground_gate", ground_gate,
            "search only where objects of the models' heights can stand, if the camera's pose is "
            "known");
  v.angle("ground_slope_sigma_deg", ground_slope_sigma, {0, 20},
          "deviation of pitch and slope of the road");
}

DetectorSetup DetectorSetup::read(Config& config) {
  auto setup = config.read<DetectorSetup>("detector");
  for (const std::string& section : config.sectionsWithPrefix(kModelPrefix)) {
    setup.models.emplace_back(section.substr(std::string(kModelPrefix).size()),
                              config.read<DetectorModelParams>(section));
  }
  setup.dpm = config.read<DpmParams>("dpm");
  setup.onnx = config.read<OnnxParams>("onnx");
  setup.hog = config.read<HogParams>("hog");
  const std::string name = setup.backendName();
  if (detectorBackends()[static_cast<std::size_t>(setup.backend)].make == nullptr)
    config.fault("detector", "backend", name + kNotBuilt);
  if (setup.models.empty() && name != "hog" && name != "file")
    config.fault("detector", "backend", name + " needs a [model.NAME] section");
  for (const auto& [key, model] : setup.models) {
    if (model.file.empty() && name != "hog" && name != "file")
      config.fault(kModelPrefix + key, "", "file: missing");
  }
  return setup;
}

std::string DetectorSetup::backendName() const {
  return detectorBackends()[static_cast<std::size_t>(backend)].name;
}

std::string DetectorSetup::pathOf(const DetectorModelParams& model) const {
  namespace fs = std::filesystem;
  std::vector<fs::path> folders{folder};
  if (const char* more = std::getenv("PERCEPTION_MODELS"); more != nullptr && *more != '\0')
    folders.emplace_back(more);
  for (const fs::path& place : folders) {
    if (fs::exists(place / model.file)) return (place / model.file).string();
  }
  throw DataError(fmt::format("{}: no such file (a model of back end {}). Models do not come with "
                              "the programs: [detector] folder or the environment's "
                              "PERCEPTION_MODELS names the folder of yours",
                              (folders.back() / model.file).string(), backendName()),
                  ExitCode::kNoInput);
}

const std::vector<DetectorBackend>& detectorBackends() {
  static const std::vector<DetectorBackend> rows{{"dpm", kMakeDpm},
                                                 {"onnx", &makeOnnxDetector},
                                                 {"hog", &makeHogDetector},
                                                 {"file", &makeNothing}};
  return rows;
}

std::unique_ptr<Detector> makeDetector(const DetectorSetup& setup) {
  const auto make = detectorBackends()[static_cast<std::size_t>(setup.backend)].make;
  if (make == nullptr) throw ConfigError(setup.backendName() + kNotBuilt);
  return make(setup);
}

std::size_t calibrateScores(const DetectorSetup& setup, std::vector<ObjectDetection>& objects) {
  std::size_t kept = 0;
  for (ObjectDetection& object : objects) {
    const DetectorModelParams* model = nullptr;
    for (const auto& [name, m] : setup.models) {
      if (m.slopeOf(object.label) > 0 && (m.label.empty() || m.label == object.label)) model = &m;
    }
    if (model == nullptr) {
      ++kept;
      continue;
    }
    object.score = model->slopeOf(object.label) * (object.score - model->evenScoreOf(object.label));
  }
  return kept;
}

}  // namespace perception
