#pragma once
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/app/KittiImport.h"

namespace perception {

/// perception-import: turns recordings of other formats into rawlogs with ground truth.
class ImportApp : public App {
 public:
  KittiImportParams kitti;              ///< of the sub-command kitti
  std::vector<std::string> detections;  ///< NAME:CLASS=FILE

  KittiImportResult out_result;

  std::string name() const override { return "perception-import"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void parseDetections();
  void report() const;
};

}  // namespace perception
