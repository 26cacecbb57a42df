#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"

namespace CLI {
class App;
}

namespace perception {

/// A format of others: its own options, and the import. Throws Error (kUsage), DataError (with file
/// and line), OutputError.
class Importer {
 public:
  virtual ~Importer() = default;
  /// The options beside those of ImportOptions.
  virtual void declare(CLI::App& cli) = 0;
  /// Before the log is opened: the format's own defaults for what the command line does not say.
  virtual void prepare(ImportOptions&) {}
  virtual void run(ImportLog& log) = 0;
};

/// Options of ImportOptions that not every format can use: a recording with stamps has its rate.
enum SharedOption : unsigned { kUsesRate = 1, kUsesImages = 2, kUsesRepeat = 4 };

/// A row per sub-command of perception-import.
struct ImporterRow {
  const char* name;
  const char* description;
  unsigned uses;  ///< SharedOption; --first and --last are everybody's
  std::unique_ptr<Importer> (*make)();
};
/// The table: one row a format. A program that brings a format of its own adds a row before it
/// runs.
std::vector<ImporterRow>& importers();

std::unique_ptr<Importer> makeKittiImporter();
std::unique_ptr<Importer> makeCloudsImporter();
std::unique_ptr<Importer> makeWadsImporter();
std::unique_ptr<Importer> makeSnowyKittiImporter();
std::unique_ptr<Importer> makeRadiateImporter();
std::unique_ptr<Importer> makeVodImporter();
std::unique_ptr<Importer> makeAv2Importer();
std::unique_ptr<Importer> makeAimotiveImporter();
std::unique_ptr<Importer> makeComma2k19Importer();
std::unique_ptr<Importer> makeUdacityImporter();
std::unique_ptr<Importer> makeImagesImporter();
std::unique_ptr<Importer> makeKittiObjectImporter();
std::unique_ptr<Importer> makeNmeaImporter();
std::unique_ptr<Importer> makeGpxImporter();

/// Throws Error (kUsage): the command line is wrong.
[[noreturn]] void failUsage(const std::string& message);

}  // namespace perception
