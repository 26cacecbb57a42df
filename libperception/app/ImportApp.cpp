#include "libperception/app/ImportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "libperception/app/Programs.h"
#include "libperception/core/Error.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {

namespace {

// A message of the command line library would not name the formats.
void requireFormat(const CLI::App& cli) {
  const std::vector<std::string> unknown = cli.remaining();
  if (!cli.get_subcommands().empty() && unknown.empty()) return;
  std::string formats;
  for (const ImporterRow& row : importers()) formats += fmt::format(" {}", row.name);
  throw CLI::ValidationError(
      unknown.empty() ? "no format is given; there are:" + formats
                      : fmt::format("{}: no such format; there are:{}", unknown.front(), formats));
}

}  // namespace

void ImportApp::declare(CLI::App& cli) {
  cli.require_subcommand(0, 1);  // none: named by requireFormat()
  importers_.clear();
  for (std::size_t i = 0; i < importers().size(); ++i) {
    const ImporterRow& row = importers()[i];
    CLI::App& sub = *cli.add_subcommand(row.name, row.description);
    sub.callback([this, i] { chosen_ = i; });
    importers_.push_back(row.make());
    importers_.back()->declare(sub);
    sub.add_option("--first", options.first, "first frame")->capture_default_str();
    sub.add_option("--last", options.last, "last frame; -1: to the end")->capture_default_str();
    if (row.uses & kUsesRate)
      sub.add_option("--rate", options.rate,
                     "[Hz] rate of frames without stamps; default: by format");
    if (row.uses & kUsesRepeat)
      sub.add_option("--repeat", options.repeat,
                     "number of repetitions of isolated frames, as a static scene")
          ->capture_default_str();
    if (row.uses & kUsesImages) {
      auto* copy =
          sub.add_flag("--copy-images", copy_images_,
                       "copy images into FILE_Images beside the log instead of linking them");
      sub.add_flag("--embed-images", embed_images_, "put images as JPEG into the log")
          ->excludes(copy);
    }
    addOutputOption(sub, (row.uses & kLists) == 0);
  }
  cli.allow_extras();
  cli.callback([&cli] { requireFormat(cli); });
}

void ImportApp::checkOptions() const {
  if (!(options.rate >= 0) || !(options.rate <= 1e4))
    failUsage("--rate must be above 0 and at most 10000 Hz");
  if (options.first < 0) failUsage("--first must be at least 0");
  if (options.last >= 0 && options.last < options.first) failUsage("--last is before --first");
  if (options.repeat < 1 || options.repeat > 1000) failUsage("--repeat must be 1 to 1000");
}

void ImportApp::run() {
  checkOptions();
  if (importers_[chosen_]->runInstead(output)) return;
  if (output.empty()) failUsage("-o: expected the log to be written");
  options.output = output;
  if (copy_images_) options.images = ImportOptions::Images::kCopy;
  if (embed_images_) options.images = ImportOptions::Images::kEmbed;
  Importer& importer = *importers_[chosen_];
  importer.prepare(options);
  std::optional<Progress> bar;
  ImportLog log(options, [&bar](std::int64_t done, std::int64_t total) {
    stopIfAsked();
    if (!bar) bar.emplace("import", static_cast<std::uint64_t>(total));
    bar->update(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(done));
  });
  importer.run(log);
  out_result = log.close();
  bar.reset();
  for (const std::string& warning : out_result.warnings) warn(warning);
  report();
}

void ImportApp::report() const {
  const ImportResult& r = out_result;
  fmt::print("{}: {} frames, {} entries, {:.2f} MB ({:.2f} MB inflated)\n", output, r.frames,
             r.entries, static_cast<double>(r.bytes) * 1e-6,
             static_cast<double>(r.bytes_inflated) * 1e-6);
  if (r.scans > 0) fmt::print("  lidar: {} scans, {} points\n", r.scans, r.points);
  if (r.radar_scans > 0)
    fmt::print("  radar: {} scans, {} returns\n", r.radar_scans, r.radar_returns);
  for (const auto& [detector, count] : r.detections)
    fmt::print("  {}: {} detections\n", detector, count);
  if (r.images > 0) fmt::print("  images: {}\n", r.images);
  if (r.poses > 0) fmt::print("  poses: {}\n", r.poses);
  for (const auto& [label, count] : r.others) fmt::print("  {}: {} entries\n", label, count);
  for (const std::string& note : r.notes) fmt::print("  {}\n", note);
  if (r.truth_file.empty()) return;
  fmt::print("{}: {} rows\n", r.truth_file, r.truth_rows);
  for (const auto& [type, count] : r.truth_types) fmt::print("  {}: {}\n", type, count);
}

std::unique_ptr<App> importApp() { return std::make_unique<ImportApp>(); }

}  // namespace perception
