#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/importers/Importer.h"

namespace perception {

/// perception-import: turns recordings of other formats into rawlogs with ground truth.
class ImportApp : public App {
 public:
  ImportApp()
      : App("perception-import",
            "Turns recordings of other formats into a rawlog and, with labels, FILE.truth.csv "
            "beside it.") {}

  ImportOptions options;  ///< of all sub-commands

  ImportResult out_result;

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void checkOptions() const;
  void report() const;

  std::vector<std::unique_ptr<Importer>> importers_;  ///< by row of importers()
  std::size_t chosen_ = 0;
  bool copy_images_ = false, embed_images_ = false;
};

}  // namespace perception
