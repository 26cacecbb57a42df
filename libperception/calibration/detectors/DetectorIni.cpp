#include "libperception/calibration/detectors/DetectorIni.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "libperception/calibration/detectors/DetectorFigures.h"

namespace perception {
namespace {

/// Share with half a pseudo-count on either side, so that it is never 0 or 1.
double smoothed(std::size_t part, std::size_t whole) {
  return (static_cast<double>(part) + 0.5) / (static_cast<double>(whole) + 1);
}

bool holds(const CredibleInterval& i, double value) { return value >= i.low && value <= i.high; }

/// A line, if the counts contradict the INI.
std::string lineOf(const char* key, const CredibleInterval& counted, double stated, double value) {
  if (holds(counted, stated)) return "";
  return fmt::format("{} = {:.3g}   ; counted {:.3g}, {:.3g} to {:.3g}; the INI says {:.3g}\n", key,
                     value, counted.value, counted.low, counted.high, stated);
}

}  // namespace

std::string detectorIni(const DetectorCounts& counts, const ClassTable& classes,
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
    const ChanceShare visible = shareOf(counts, c, [](const auto& k) { return k.occluded <= 1; });
    if (visible.all < kFewestSamples) continue;
    const ChanceShare hidden = shareOf(counts, c, [](const auto& k) { return k.occluded == 2; });
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

std::string gainsIni(const DetectorCounts& counts, const DetectorStudyInput& input,
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
    const ChanceShare share = shareOf(counts, c, visible);
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

}  // namespace perception
