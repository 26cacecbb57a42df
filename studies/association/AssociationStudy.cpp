#include "studies/association/AssociationStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "libperception/evaluation/plots/Gnuplot.h"

namespace perception {
namespace {

const std::vector<AssociationMethod>& methods() {
  static const std::vector<AssociationMethod> all = {
      {"nearest", Proposal::kNearest, 1},     {"sampled 1", Proposal::kSampled, 1},
      {"sampled 4", Proposal::kSampled, 4},   {"sampled 8", Proposal::kSampled, 8},
      {"sampled 20", Proposal::kSampled, 20}, {"sampled 50", Proposal::kSampled, 50},
      {"ranked 1", Proposal::kRanked, 1},     {"ranked 4", Proposal::kRanked, 4},
      {"ranked 8", Proposal::kRanked, 8},     {"ranked 20", Proposal::kRanked, 20}};
  return all;
}

}  // namespace

const std::vector<AssociationScene>& associationScenes() {
  static const std::vector<AssociationScene> scenes = {
      {"D hard", "D", {0.75, 3, 1, 0.7}},
      {"E0.8_1.5", "E0.8_1.5", {}},
      {"E0.7_1.0", "E0.7_1.0", {}},
      {"E0.6_0.5", "E0.6_0.5", {}},
      {"C0.5 hard", "C0.5", {0.75, 3, 1, 0.7}},
  };
  return scenes;
}

FilterModel associationModel(Proposal proposal) {
  FilterModel model;
  model.classes = encounterClasses();
  ObjectClass& pedestrian = model.classes.classes[0];
  pedestrian.mode_accel_psd = {0.04, 0.5};  // walking ([radecki2016]'s .04) and stopping or turning
  pedestrian.mode_damping = {0, 3};
  pedestrian.mode_sojourn = {4, 1.5};  // method.md 3.6
  model.params.kinematic_exponent = 1;
  model.proposal = proposal;
  return model;
}

AssociationFigures runAssociation(const AssociationScene& scene, const AssociationMethod& method,
                                  int seeds) {
  const FilterModel model = associationModel(method.proposal);
  std::vector<EncounterScore> scores(static_cast<std::size_t>(seeds));
  tbb::parallel_for(std::size_t{0}, scores.size(), [&](std::size_t i) {
    scores[i] = runEncounter(scene.scene, scene.conditions, model, method.particles, i + 1, i + 1);
  });
  AssociationFigures f;
  f.runs = seeds;
  for (const auto& s : scores) {
    f.swaps += s.swapped;
    f.gospa += s.gospa / seeds;
    f.tracked += s.tracked / seeds;
  }
  return f;
}

StudyReport associationStudy(const AssociationParams& params) {
  StudyReport report;
  report.title = "Identities through encounters";
  report.data = fmt::format(
      "simulated positions and labels of a lidar and a camera, seeds 1-{}, one configuration for "
      "all scenes (walking modes of .04 and .5 m^2/s^3, the second damped by 3/s)",
      params.seeds);
  StudyTable swaps, errors;
  swaps.name = "swaps";
  swaps.title = "Share of runs with an identity swap (Wilson's 95 % upper bound)";
  errors.name = "gospa";
  errors.title = "Mean GOSPA [m], cut-off 2 m, and share of instants tracked";
  swaps.columns = errors.columns = {"method"};
  for (const auto& scene : associationScenes()) {
    swaps.columns.push_back(scene.label);
    errors.columns.push_back(scene.label);
  }
  std::string data;
  for (const auto& method : methods()) {
    std::vector<std::string> swap_row{method.label}, error_row{method.label};
    std::string line = fmt::format("\"{}\"", method.label);
    for (const auto& scene : associationScenes()) {
      const auto f = runAssociation(scene, method, params.seeds);
      const double rate = static_cast<double>(f.swaps) / f.runs;
      swap_row.push_back(fmt::format("{:.3f} (<{:.3f})", rate, wilsonUpper(f.swaps, f.runs)));
      error_row.push_back(fmt::format("{:.3f} / {:.3f}", f.gospa, f.tracked));
      line += fmt::format(" {:.4f}", rate);
    }
    swaps.rows.push_back(swap_row);
    errors.rows.push_back(error_row);
    data += line + '\n';
  }
  report.tables = {swaps, errors};
  StudyPlot plot;
  plot.name = "swaps";
  plot.caption =
      "Share of simulated runs in which an object's identity differs before and after "
      "the encounter.";
  plot.width = 1100;
  plot.data = {{"swaps.dat", data}};
  plot.script =
      "set style data histograms\nset style histogram clustered gap 1\n"
      "set style fill solid 0.8\nset grid ytics\nset yrange [0:*]\n"
      "set ylabel 'share of runs with a swap'\nset key top right\nplot ";
  for (std::size_t s = 0; s < associationScenes().size(); ++s) {
    plot.script += fmt::format("{}'swaps.dat' using {}:xtic(1) title {} noenhanced", s ? ", " : "",
                               s + 2, gnuplotString(associationScenes()[s].label));
  }
  plot.script += '\n';
  report.plots = {plot};
  return report;
}

}  // namespace perception
