#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/doctor/DoctorReport.h"
#include "libperception/importers/InputKind.h"

namespace perception {

/// perception-doctor: what a log holds, what is wrong with it, and a first INI for its vehicle.
class DoctorApp : public App {
 public:
  std::string ini_folder;  ///< --ini: of classes.ini; empty: ini/ of the program's tree

  std::string name() const override { return "perception-doctor"; }
  std::string description() const override {
    return "Examines a rawlog and writes a first INI for its vehicle; of other recordings it says "
           "what they are and how to import them";
  }
  void declare(CLI::App& cli) override;
  void run() override;

  std::vector<Finding> out_findings;
  std::optional<InputKind> out_kind;  ///< of a recording that is no rawlog
};

}  // namespace perception
