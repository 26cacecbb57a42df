#include "libperception/calibration/detectors/DetectorStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "libperception/calibration/detectors/DetectorFigures.h"
#include "libperception/calibration/detectors/DetectorIni.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::array<double, 5> kRanges{0, 10, 20, 40, 80};  // [m] borders of the tables

std::string percent(std::size_t part, std::size_t whole) {
  return whole < kFewestSamples ? "n/a"
                                : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) /
                                                            static_cast<double>(whole));
}

std::string span(std::size_t r) { return fmt::format("{:.0f}-{:.0f}", kRanges[r], kRanges[r + 1]); }

void addDetection(const DetectorCounts& counts, const ClassTable& classes, StudyTable& table) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (std::size_t r = 0; r + 1 < kRanges.size(); ++r) {
      const auto within = [&](const DetectorChance& k) {
        return k.range >= kRanges[r] && k.range < kRanges[r + 1];
      };
      const ChanceShare all = shareOf(counts, c, within);
      if (all.all < kFewestSamples) continue;
      std::vector<std::string> row = {counts.sensor, classes[c].name, span(r),
                                      fmt::format("{}", all.all)};
      for (int o = 0; o <= 2; ++o) {
        const ChanceShare s =
            shareOf(counts, c, [&](const auto& k) { return within(k) && k.occluded == o; });
        row.push_back(percent(s.seen, s.all));
      }
      row.push_back(percent(all.seen, all.all));
      const CredibleInterval p = detectionOf(counts, c, within);
      row.push_back(fmt::format("{:.1f} to {:.1f}", 100 * p.low, 100 * p.high));
      row.push_back(fmt::format("{:.1f}", 100 * all.stated / static_cast<double>(all.all)));
      table.rows.push_back(std::move(row));
    }
  }
}

void addNoise(const DetectorCounts& counts, const ClassTable& classes, StudyTable& table) {
  std::vector<std::string> quantities;
  for (const DetectorError& e : counts.errors) {
    if (std::find(quantities.begin(), quantities.end(), e.quantity) == quantities.end())
      quantities.push_back(e.quantity);
  }
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const std::string& q : quantities) {
      for (std::size_t r = 0; r + 1 < kRanges.size(); ++r) {
        std::vector<const DetectorError*> some;
        for (const DetectorError& e : counts.errors) {
          if (e.class_id == c && e.quantity == q && e.range >= kRanges[r] &&
              e.range < kRanges[r + 1])
            some.push_back(&e);
        }
        if (some.size() < kFewestSamples) continue;
        const ErrorFigures f = figuresOf(some);
        table.rows.push_back({counts.sensor, classes[c].name, q, span(r),
                              fmt::format("{}", f.count), fmt::format("{:.4f}", f.mean),
                              fmt::format("{:.4f}", f.rms), fmt::format("{:.4f}", f.stated),
                              fmt::format("{:.2f}", f.nis), fmt::format("{:.2f}", f.repeated)});
      }
    }
  }
}

void addLabels(const DetectorCounts& counts, const ClassTable& classes,
               const std::vector<std::string>& labels, StudyTable& table) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    const LabelCounts n = labelsOf(counts, c, labels.size());
    if (n.all < kFewestSamples) continue;
    for (std::size_t l = 0; l < labels.size(); ++l) {
      table.rows.push_back(
          {counts.sensor, classes[c].name, labels[l], fmt::format("{}", n.of[l]),
           percent(n.of[l], n.all),
           fmt::format("{:.1f}", 100 * counts.label[static_cast<std::size_t>(c)][l])});
    }
  }
}

std::vector<std::string> scansRow(const std::string& sensor, const DetectorCounts& c) {
  const std::size_t clutter = std::accumulate(c.clutter.begin(), c.clutter.end(), std::size_t{0});
  const double n = static_cast<double>(std::max<std::size_t>(c.scans, 1));
  const CredibleInterval rate = rateOf(c, &ClutterCount::number);
  return {sensor,
          fmt::format("{}", c.scans),
          fmt::format("{}", clutter),
          fmt::format("{:.3f}", static_cast<double>(clutter) / n),
          fmt::format("{:.3f} to {:.3f}", rate.low, rate.high),
          fmt::format("{}", c.first_seen),
          fmt::format("{:.3f}", static_cast<double>(c.first_seen) / n)};
}

}  // namespace

StudyReport detectorStudy(const DetectorStudyInput& input,
                          const std::map<std::string, DetectorCounts>& counts) {
  if (counts.empty()) throw DataError("no scan of a detector stands beside labeled objects");
  StudyReport report;
  report.title = "What detectors see of labeled objects";
  report.data = fmt::format("{}logs {}", input.simulated ? "simulated " : "", input.logs);
  StudyTable scans{"scans",
                   "Scans, clutter and newly detected objects",
                   {"sensor", "scans", "on nothing labeled", "a scan", "90 % interval",
                    "objects detected", "a scan"},
                   {}};
  StudyTable detection{"detection",
                       "Labeled objects in view that have a detection (%)",
                       {"sensor", "class", "range (m)", "objects", "in full view", "partly hidden",
                        "largely hidden", "all", "90 % interval", "the INI, unhidden"},
                       {}};
  StudyTable labels{"labels",
                    "Labels of detections on objects (%)",
                    {"sensor", "class", "label", "detections", "share", "the INI"},
                    {}};
  StudyTable noise{"noise",
                   "Errors of detections on objects against what is stated",
                   {"sensor", "class", "quantity", "range (m)", "detections", "mean", "rms",
                    "stated", "NIS", "repeated after 1 s"},
                   {}};
  const bool gains = !input.include.empty();
  StudyTable keys{"keys",
                  "Counted against the INI",
                  {"section", "key", "counted", "90 % interval", "the INI", ""},
                  {}};
  std::string ini = fmt::format("; Counted by perception-calibrate {} on {}.\n",
                                gains ? "gains" : "detector", input.logs);
  if (gains) ini += "include = " + input.include + "\n\n";
  for (const auto& [sensor, c] : counts) {
    const auto& names = input.labels.at(sensor);
    scans.rows.push_back(scansRow(sensor, c));
    addDetection(c, input.classes, detection);
    addLabels(c, input.classes, names, labels);
    addNoise(c, input.classes, noise);
    ini += gains ? gainsIni(c, input, keys) : detectorIni(c, input.classes, names);
  }
  report.tables = {std::move(scans), std::move(detection), std::move(labels), std::move(noise)};
  if (gains) report.tables.insert(report.tables.begin(), std::move(keys));
  report.files.emplace_back(gains ? "gains.ini" : "detector.ini", ini);
  report.remarks = {
      "Intervals hold the true value in 90 % of logs (method.md 8.14): what is seen within 4 s "
      "counts as dependent.",
      gains ? "`gains.ini` holds the keys whose interval does not hold the INI's value."
            : "`detector.ini` holds the counted keys; scores are fitted by `perception-calibrate "
              "boxes`.",
      "NIS: mean of (error / stated deviation)^2, 1 when the noise is honest, less when cautious. "
      "Repeated: correlation of one object's errors a second apart; a filter takes them for "
      "independent, so stated deviations must be larger than the errors where it is high.",
      "Areas that the truth does not label (DontCare) cannot be told from clutter, nor objects "
      "that have no label. Bearings in rad, lengths in m, axes in rad."};
  return report;
}

}  // namespace perception
