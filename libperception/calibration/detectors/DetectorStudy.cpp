#include "libperception/calibration/detectors/DetectorStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "libperception/calibration/detectors/Intervals.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::array<double, 5> kRanges{0, 10, 20, 40, 80};  // [m] borders of the tables
constexpr std::size_t kFewestSamples = 20;  // fewest samples of a share: one in twenty is 5 %

/// [s] Within it detections of one scene depend on each other: an object stays hidden.
constexpr double kBlock = 4;

std::vector<BlockCount> valuesOf(const std::map<std::pair<std::size_t, long>, BlockCount>& blocks) {
  std::vector<BlockCount> out;
  for (const auto& [key, block] : blocks) out.push_back(block);
  return out;
}

std::pair<std::size_t, long> blockOf(std::size_t log, double t) {
  return {log, std::lround(std::floor(t / kBlock))};
}

/// P_D of a class with its interval, of chances that `pick` takes.
template <typename Pick>
CredibleInterval detectionOf(const DetectorCounts& counts, ClassId c, Pick pick) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || !pick(k)) continue;
    BlockCount& block = blocks[blockOf(k.log, k.t)];
    ++block.chances, block.events += k.label >= 0 ? 1 : 0;
  }
  return shareInterval(valuesOf(blocks));
}

/// What a scan has, detections on nothing or objects that enter, with its interval.
CredibleInterval rateOf(const DetectorCounts& counts, std::size_t ClutterCount::*what) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const ClutterCount& scan : counts.clutter_scans) {
    BlockCount& block = blocks[blockOf(scan.log, scan.t)];
    ++block.chances, block.events += static_cast<double>(scan.*what);
  }
  return rateInterval(valuesOf(blocks));
}

/// Share of a label among the detections of a class, with its interval.
CredibleInterval labelOf(const DetectorCounts& counts, ClassId c, int label) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || k.label < 0) continue;
    BlockCount& block = blocks[blockOf(k.log, k.t)];
    ++block.chances, block.events += k.label == label ? 1 : 0;
  }
  return shareInterval(valuesOf(blocks));
}

/// The errors of places and edges on road users over what is stated, [-] root mean square, with its
/// interval; without errors low is 0.
CredibleInterval noiseOf(const DetectorCounts& counts, const ClassTable& classes) {
  static const std::set<std::string> kPlaces = {"left", "right", "range", "across"};
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  std::size_t all = 0;
  for (const DetectorError& e : counts.errors) {
    if (!classes[e.class_id].reported || kPlaces.count(e.quantity) == 0) continue;
    BlockCount& block = blocks[blockOf(e.log, e.t)];
    const double normalized = e.error / e.sigma;
    ++block.chances, block.events += normalized * normalized, ++all;
  }
  if (all < kFewestSamples) return {1, 0, 1e3};
  const CredibleInterval square = rateInterval(valuesOf(blocks));
  return {std::sqrt(square.value), std::sqrt(square.low), std::sqrt(square.high)};
}

bool holds(const CredibleInterval& i, double value) { return value >= i.low && value <= i.high; }

std::string percent(std::size_t part, std::size_t whole) {
  return whole < kFewestSamples ? "n/a"
                                : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) /
                                                            static_cast<double>(whole));
}

std::string span(std::size_t r) { return fmt::format("{:.0f}-{:.0f}", kRanges[r], kRanges[r + 1]); }

struct Share {
  std::size_t seen = 0, all = 0;
  double stated = 0;
};

template <typename Pick>
Share shareOf(const DetectorCounts& counts, ClassId c, Pick pick) {
  Share s;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || !pick(k)) continue;
    ++s.all, s.seen += k.label >= 0, s.stated += k.stated;
  }
  return s;
}

void addDetection(const DetectorCounts& counts, const ClassTable& classes, StudyTable& table) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (std::size_t r = 0; r + 1 < kRanges.size(); ++r) {
      const auto within = [&](const DetectorChance& k) {
        return k.range >= kRanges[r] && k.range < kRanges[r + 1];
      };
      const Share all = shareOf(counts, c, within);
      if (all.all < kFewestSamples) continue;
      std::vector<std::string> row = {counts.sensor, classes[c].name, span(r),
                                      fmt::format("{}", all.all)};
      for (int o = 0; o <= 2; ++o) {
        const Share s =
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

struct LabelCounts {
  std::vector<std::size_t> of;  ///< by label
  std::size_t all = 0;
};

LabelCounts labelsOf(const DetectorCounts& counts, ClassId c, std::size_t labels) {
  LabelCounts out{std::vector<std::size_t>(labels, 0), 0};
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || k.label < 0) continue;
    ++out.of[static_cast<std::size_t>(k.label)], ++out.all;
  }
  return out;
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

/// Share with half a pseudo-count on either side, so that it is never 0 or 1.
double smoothed(std::size_t part, std::size_t whole) {
  return (static_cast<double>(part) + 0.5) / (static_cast<double>(whole) + 1);
}

std::string iniOf(const DetectorCounts& counts, const ClassTable& classes,
                  const std::vector<std::string>& labels) {
  const double scans = static_cast<double>(std::max<std::size_t>(counts.scans, 1));
  const std::size_t clutter =
      std::accumulate(counts.clutter.begin(), counts.clutter.end(), std::size_t{0});
  const CredibleInterval rate = rateOf(counts, &ClutterCount::number);
  std::string text = fmt::format(
      "[sensor.{}]\nclutter_per_scan = {:.3g}   ; {:.3g} to {:.3g}; {} detections on nothing "
      "labeled in {} scans\n"
      "births_per_scan = {:.3g}   ; {} objects were detected for the first time\n",
      counts.sensor, std::max(static_cast<double>(clutter), 0.5) / scans, rate.low, rate.high,
      clutter, counts.scans, static_cast<double>(counts.first_seen) / scans, counts.first_seen);
  for (std::size_t l = 0; l < labels.size(); ++l) {
    text += fmt::format("clutter_label.{} = {:.3f}   ; {}\n", labels[l],
                        smoothed(counts.clutter[l], clutter), counts.clutter[l]);
  }
  for (ClassId c = 0; c < classes.size(); ++c) {
    const Share visible = shareOf(counts, c, [](const auto& k) { return k.occluded <= 1; });
    if (visible.all < kFewestSamples) continue;
    const Share hidden = shareOf(counts, c, [](const auto& k) { return k.occluded == 2; });
    const CredibleInterval p =
        detectionOf(counts, c, [](const auto& k) { return k.occluded <= 1; });
    text += fmt::format(
        "[sensor.{}.class.{}]\ndetection = {:.2f}   ; {:.2f} to {:.2f}; {} of {} not or partly "
        "hidden; {} of {} "
        "largely hidden\n",
        counts.sensor, classes[c].name, smoothed(visible.seen, visible.all), p.low, p.high,
        visible.seen, visible.all, hidden.seen, hidden.all);
    const LabelCounts n = labelsOf(counts, c, labels.size());
    for (std::size_t l = 0; l < labels.size() && n.all >= kFewestSamples; ++l) {
      text += fmt::format("label.{} = {:.3f}   ; {} of {}\n", labels[l], smoothed(n.of[l], n.all),
                          n.of[l], n.all);
    }
  }
  return text;
}

/// A line, if the counts contradict the INI.
std::string lineOf(const char* key, const CredibleInterval& counted, double stated, double value) {
  if (holds(counted, stated)) return "";
  return fmt::format("{} = {:.3g}   ; counted {:.3g}, {:.3g} to {:.3g}; the INI says {:.3g}\n", key,
                     value, counted.value, counted.low, counted.high, stated);
}

std::string gainsOf(const DetectorCounts& counts, const DetectorStudyInput& input,
                    StudyTable& table) {
  const auto& labels = input.labels.at(counts.sensor);
  const DetectionParams& stated = input.stated.at(counts.sensor);
  const auto add = [&](const std::string& section, const std::string& key,
                       const CredibleInterval& counted, double ini, bool written) {
    table.rows.push_back({section, key, fmt::format("{:.3g}", counted.value),
                          fmt::format("{:.3g} to {:.3g}", counted.low, counted.high),
                          fmt::format("{:.3g}", ini), written ? "written" : "kept"});
  };
  const std::string section = "sensor." + counts.sensor;
  const CredibleInterval clutter = rateOf(counts, &ClutterCount::number),
                         births = rateOf(counts, &ClutterCount::entered),
                         noise = noiseOf(counts, input.classes);
  add(section, "clutter_per_scan", clutter, stated.clutter_per_scan,
      !holds(clutter, stated.clutter_per_scan));
  add(section, "births_per_scan", births, stated.births_per_scan,
      !holds(births, stated.births_per_scan));
  const double least = 0.5 / static_cast<double>(std::max<std::size_t>(counts.scans, 1));
  std::string text =
      lineOf("clutter_per_scan", clutter, stated.clutter_per_scan, std::max(clutter.value, least)) +
      lineOf("births_per_scan", births, stated.births_per_scan, std::max(births.value, least));
  // Smaller errors than stated may repeat, which the filter takes for information: they stay.
  const double scale = stated.noise_scale;
  add(section, "noise_scale", {scale * noise.value, scale * noise.low, scale * noise.high}, scale,
      noise.low > 1);
  if (noise.low > 1)
    text += fmt::format(
        "noise_scale = {:.3g}   ; errors of {:.3g} to {:.3g} times the stated deviations\n",
        std::min(20.0, stated.noise_scale * noise.value), noise.low, noise.high);
  if (!text.empty()) text = "[" + section + "]\n" + text;
  for (ClassId c = 0; c < input.classes.size(); ++c) {
    const auto visible = [](const DetectorChance& k) { return k.occluded <= 1; };
    const Share share = shareOf(counts, c, visible);
    if (share.all < kFewestSamples) continue;
    const CredibleInterval p = detectionOf(counts, c, visible);
    const double mean = share.stated / static_cast<double>(share.all);  // over the ranges met
    double near = 0;  // P_D by the INI where nothing lessens it
    for (const DetectorChance& k : counts.chances)
      if (k.class_id == c) near = std::max(near, k.stated);
    const std::string of_class = section + ".class." + input.classes[c].name;
    add(of_class, "detection", p, mean, !holds(p, mean));
    std::string lines = lineOf("detection", p, mean, std::clamp(near * p.value / mean, 0.01, 0.99));
    const LabelCounts n = labelsOf(counts, c, labels.size());
    const auto& table_row = counts.label[static_cast<std::size_t>(c)];
    std::string shares;
    bool contradicted = false;
    for (std::size_t l = 0; l < labels.size() && n.all >= kFewestSamples; ++l) {
      const CredibleInterval q = labelOf(counts, c, static_cast<int>(l));
      contradicted = contradicted || !holds(q, table_row[l]);
      add(of_class, "label." + labels[l], q, table_row[l], !holds(q, table_row[l]));
      shares +=
          fmt::format("label.{} = {:.3f}   ; {} of {}, {:.3g} to {:.3g}; the INI says {:.3g}\n",
                      labels[l], q.value, n.of[l], n.all, q.low, q.high, table_row[l]);
    }
    if (contradicted) lines += shares;
    if (!lines.empty()) text += "[" + of_class + "]\n" + lines;
  }
  return text;
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
    ini += gains ? gainsOf(c, input, keys) : iniOf(c, input.classes, names);
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
