#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

/// perception-simulate: a scenario INI becomes a rawlog with ground truth; a recording, one in
/// simulated weather.
class SimulateApp : public App {
 public:
  SimulateApp()
      : App("perception-simulate",
            "Simulates a scenario: writes a rawlog and the truth, FILE.truth.csv, beside it.") {}

  std::uint64_t seed = 1;     ///< --seed
  int gzip_level = 1;         ///< --gzip
  int trial = 0;              ///< --trial; 0 = the unchanged scenario
  std::string coverage;       ///< --coverage: output picture of the coverage of the sensors of -c
  std::string contact_sheet;  ///< --contact-sheet: output picture of `scenes`
  std::vector<std::string> scenes;  ///< scenario INIs of the contact sheet
  std::string vehicle;              ///< --vehicle: INI whose sensors replace those of the scenario
  std::string weather;              ///< --weather: INI whose [weather] replaces the scenario's

  std::string out_truth_file;
  std::int64_t out_frames = 0;
  std::uint64_t out_entries = 0, out_bytes = 0, out_points = 0, out_boxes = 0, out_beams = 0,
                out_targets = 0, out_labels = 0;
  std::uint64_t out_lost = 0, out_phantoms = 0;  ///< returns of a recording in weather

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  CLI::App* recording_ = nullptr;  // the subcommand
  /// The scenario of -c with --vehicle, --weather and --trial applied; nothing after
  /// --print-config.
  std::optional<Scenario> loadScenario();
  /// The subcommand: weather on a recording.
  void declareRecording(CLI::App& cli);
  void alterRecording();
  void writeLabels(std::int64_t frame, const std::vector<std::uint32_t>& labels);
  void drawCoverage();
  void drawContactSheet();
};

}  // namespace perception
