#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"

namespace CLI {
class App;
}

namespace perception {

/// Importer of one recording format: its options and the import. Methods throw Error (kUsage),
/// DataError (with file and line), OutputError.
class Importer {
 public:
  virtual ~Importer() = default;
  /// Declares the options of the format, besides ImportOptions.
  virtual void declare(CLI::App& cli) = 0;
  /// Sets format-specific defaults of options not given on the command line; called before the log
  /// is opened.
  virtual void prepare(ImportOptions&) {}
  /// Does what is not the import of a log, if the options ask for that: prints what the recording
  /// holds, writes the truth of a log that is there. `output`: of the command line, may be empty.
  virtual bool runInstead(const std::string&) { return false; }
  virtual void run(ImportLog& log) = 0;
};

/// Options of ImportOptions that only some formats use.
enum SharedOption : unsigned { kUsesRate = 1, kUsesImages = 2, kUsesRepeat = 4, kLists = 8 };

/// Registry entry: a sub-command of perception-import.
struct ImporterRow {
  const char* name;
  const char* description;
  unsigned uses;  ///< SharedOption flags; all formats have --first and --last
  std::unique_ptr<Importer> (*make)();
};
/// Registry of formats. A program may append rows before runApp().
std::vector<ImporterRow>& importers();

std::unique_ptr<Importer> makeKittiImporter();
std::unique_ptr<Importer> makeKittiRawImporter();
std::unique_ptr<Importer> makeSemanticKittiImporter();
std::unique_ptr<Importer> makeCadcImporter();
std::unique_ptr<Importer> makeBoreasImporter();
std::unique_ptr<Importer> makeSemanticSprayImporter();
std::unique_ptr<Importer> makeCloudsImporter();
std::unique_ptr<Importer> makeWadsImporter();
std::unique_ptr<Importer> makeSnowyKittiImporter();
std::unique_ptr<Importer> makeRadiateImporter();
std::unique_ptr<Importer> makeVodImporter();
std::unique_ptr<Importer> makeAv2Importer();
std::unique_ptr<Importer> makeNuscenesImporter();
std::unique_ptr<Importer> makeAimotiveImporter();
std::unique_ptr<Importer> makeComma2k19Importer();
std::unique_ptr<Importer> makeUdacityImporter();
std::unique_ptr<Importer> makeImagesImporter();
std::unique_ptr<Importer> makeKittiObjectImporter();
std::unique_ptr<Importer> makePacketsImporter();
std::unique_ptr<Importer> makeNmeaImporter();
std::unique_ptr<Importer> makeGpxImporter();
std::unique_ptr<Importer> makeBagImporter();
std::unique_ptr<Importer> makeVehicleTruthImporter();

/// Throws Error (kUsage).
[[noreturn]] void failUsage(const std::string& message);

}  // namespace perception
