#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/app/Programs.h"
#include "libperception/config/ShippedFiles.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/doctor/DoctorReport.h"
#include "libperception/doctor/SiteIni.h"
#include "libperception/importers/InputKind.h"
#include "libperception/pictures/ReportFolders.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// perception-doctor: what a log holds, what is wrong with it, and a first INI for its vehicle.
class DoctorApp : public App {
 public:
  DoctorApp()
      : App("perception-doctor",
            "Examines a rawlog and writes a first INI for its vehicle; of other recordings it says "
            "what they are and how to import them") {}

  std::string ini_folder;  ///< --ini: of classes.ini; empty: ini/ of the program's tree

  void declare(CLI::App& cli) override;
  void run() override;
};

fs::path iniFolder(const std::string& asked) {
  return asked.empty() ? fs::path(shippedFolder()) / "ini" : fs::path(asked);
}

SiteFiles siteFiles(const fs::path& ini) {
  if (!fs::exists(ini / "classes.ini"))
    throw Error(ExitCode::kNoInput,
                fmt::format("{}: not found; --ini names the folder of classes.ini",
                            (ini / "classes.ini").string()));
  const fs::path model = ini / "models" / "lidar_recordings.json";
  SiteFiles files;
  files.classes = fs::absolute(ini / "classes.ini").lexically_normal().string();
  if (fs::exists(model)) files.model = fs::absolute(model).lexically_normal().string();
  return files;
}

}  // namespace

void DoctorApp::declare(CLI::App& cli) {
  addInputOption(cli, true);
  addOutputOption(cli, false);
  cli.add_option("--ini", ini_folder, "Folder of classes.ini and models/ (the shipped ini/)");
  cli.add_flag("--strict", strict, "Treat damaged input as an error instead of a warning");
}

void DoctorApp::run() {
  registerPerceptionClasses();
  if (inputs.size() != 1)
    throw Error(ExitCode::kUsage, "-i/--input: one rawlog, or one recording of any kind");
  if (const auto kind = inputKind(inputs[0])) return fmt::print("{}", textOf(*kind, inputs[0]));
  if (output.empty())
    throw Error(ExitCode::kUsage, "-o/--output: expected a folder for the report");
  const SiteFiles files = siteFiles(iniFolder(ini_folder));
  RawlogReader reader(inputs[0]);
  LogSurvey survey(imagesBeside(inputs[0]));
  while (const auto observation = reader.next()) {
    stopIfAsked();
    survey.look(*observation);
  }
  if (reader.end() != RawlogReader::End::kClean) {
    if (strict) throw DataError(reader.endMessage());
    warn(reader.endMessage());
  }
  const std::string log = fs::path(inputs[0]).filename().string();
  const std::vector<Finding> findings = findingsOf(survey);
  StudyReport report = doctorReport(survey, findings, log);
  const std::string ini = siteIni(survey, files, log);
  if (!ini.empty()) report.files.emplace_back("site.ini", ini);
  for (const auto& message : writeStudyReport(report, output)) warn(message);
  fmt::print("{}\n{}\n{}\n{} in {}\n", inputs[0], survey.contents().table(), reportText(findings),
             ini.empty() ? "report.md and doctor.png (no site.ini: no sensor for it)"
                         : "report.md, doctor.png and site.ini",
             output);
}

std::unique_ptr<App> doctorApp() { return std::make_unique<DoctorApp>(); }

}  // namespace perception
