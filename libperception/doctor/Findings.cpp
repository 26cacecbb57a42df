#include "libperception/doctor/Findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "libperception/doctor/MotionFindings.h"
#include "libperception/doctor/SiteIni.h"
#include "libperception/measurement/frames/NoReturns.h"
#include "libperception/measurement/frames/ScanTimes.h"

namespace perception {
namespace {

using Weight = Finding::Weight;

/// A gap of this many periods is one: single frames are lost everywhere.
constexpr double kGapPeriods = 3;
/// [Hz] Slower, objects move by more than their size from frame to frame.
constexpr double kSlow = 2;

/// [s] A frame that is written this late is late; more is a clock that was set back.
constexpr double kLateFrame = 0.3;
/// [s] between the times of two sensors that are not of one drive.
constexpr double kApart = 1;

void addTiming(Findings& out, const std::string& label, const SensorFacts& facts) {
  const double rate = facts.rate(), gap = facts.longestGap();
  if (facts.unusable > 0)
    out.add(Weight::kFault, label, fmt::format("{} observations cannot be used", facts.unusable));
  if (facts.frames < 2) return;
  if (rate > 0 && rate < kSlow)
    out.add(Weight::kNote, label,
            fmt::format("{:.2f} Hz: too slow to follow objects from frame to frame", rate));
  if (gap * rate > kGapPeriods)
    out.add(Weight::kNote, label,
            fmt::format("longest gap {:.2f} s, {:.0f} periods", gap, gap * rate));
}

/// Stamps that do not go on, and times of returns that are not of their scan.
void addOrder(Findings& out, const std::string& label, const SensorFacts& facts) {
  if (facts.backward > 0)
    out.add(
        facts.farthest_back > kLateFrame ? Weight::kFault : Weight::kNote, label,
        fmt::format("time goes back: {} of {} frames are older than one before, by up to {:.3f} s",
                    facts.backward, facts.frames, facts.farthest_back));
  if (facts.timeless > 0)
    out.add(Weight::kFault, label,
            fmt::format("returns lie more than {:g} s outside of {} of {} scans: other units or "
                        "another clock; perception-import leaves such times out",
                        kLongestScan, facts.timeless, facts.frames));
  if (facts.no_returns > 0)
    out.add(Weight::kFault, label,
            fmt::format("{} points are no returns: they lie farther than {:g} m, or in many "
                        "directions at the same farthest range; perception-import leaves such out",
                        facts.no_returns, kFarthestReturn));
}

/// The sensor whose stamps are of another time than those of all others.
void addClocks(Findings& out, const LogSurvey& survey) {
  struct Span {
    std::string label;
    Stamp first, last;
  };
  std::vector<Span> spans;
  for (const auto& [label, facts] : survey.sensors()) {
    if (facts.stamps.empty()) continue;
    const auto [first, last] = std::minmax_element(facts.stamps.begin(), facts.stamps.end());
    spans.push_back({label, *first, *last});
  }
  for (const auto& [label, poses] : survey.poses()) {
    if (!poses.empty()) spans.push_back({label, poses.front().stamp, poses.back().stamp});
  }
  for (const Span& span : spans) {
    std::optional<double> apart;
    for (const Span& other : spans) {
      if (&other == &span) continue;
      const double gap = std::max(span.first - other.last, other.first - span.last);
      apart = std::min(apart.value_or(gap), gap);
    }
    if (apart && *apart > kApart)
      out.add(Weight::kFault, span.label,
              fmt::format("its stamps lie {:.3f} s apart from those of everything else: do the "
                          "clocks differ?",
                          *apart));
  }
}

void addValues(Findings& out, const std::string& label, const SensorFacts& facts) {
  const DecodeCounts& n = facts.counts;
  if (n.not_finite + n.bad_returns + n.bad_boxes > 0) {
    out.add(Weight::kNote, label,
            fmt::format("{} values that are not finite or no sizes: dropped",
                        n.not_finite + n.bad_returns + n.bad_boxes));
  }
  if (facts.frames > 0 && facts.returns == 0 && facts.kind != "image")
    out.add(Weight::kFault, label, "no return or box in any frame");
  if (facts.pose_varies)
    out.add(Weight::kNote, label, "its mounting changes within the log; the first is checked");
}

void addLidar(Findings& out, const std::string& label, const SensorFacts& facts) {
  out.add(Weight::kFine, label,
          fmt::format("{:.0f} returns a scan, 99.9 % within {:.0f} m, {:.0f} deg wide",
                      static_cast<double>(facts.returns) / static_cast<double>(facts.frames),
                      facts.rangeBelow(0.999), degrees(facts.angleOf(0.999))));
  const std::string missing = facts.inputs ? facts.inputs->missing() : "";
  if (!missing.empty()) out.add(Weight::kNote, label, missing + ": left out of the evidence");
  if (!facts.high) {
    out.add(Weight::kNote, label, "[weather] filter is left off without intensities");
  } else if (*facts.high > 1.001 || *facts.low < 0) {
    out.add(Weight::kFault, label,
            fmt::format("intensity {:g} to {:g}: expected 0 to 1", *facts.low, *facts.high));
  } else {
    out.add(Weight::kFine, label,
            fmt::format("intensity {:.3f} to {:.3f}", *facts.low, *facts.high));
  }
  if (facts.planar) {
    out.add(Weight::kNote, label,
            fmt::format("mounting not observable: one layer shows no ground plane; the log has it "
                        "{:.2f} m high",
                        facts.T_ego_sensor.translation().z()));
    return;
  }
  const auto m = groundMounting(facts);
  if (!m) {
    out.add(Weight::kNote, label,
            "mounting not observable: fewer than three scans show the ground");
    return;
  }
  if (!m->steady()) {
    out.add(Weight::kNote, label,
            fmt::format("mounting not observable: the ground's pitch varies by {:.2f} deg from "
                        "scan to scan, so little of it is seen",
                        degrees(m->spread)));
    return;
  }
  const std::string found = fmt::format(
      "{:.2f} m above the ground, pitch {:.2f} deg, roll {:.2f} deg (median of {} scans, pitch "
      "varies by {:.2f} deg)",
      m->height, degrees(m->pitch), degrees(m->roll), m->scans, degrees(m->spread));
  if (!m->wrong()) return out.add(Weight::kFine, label, found + ", as the log says");
  out.add(Weight::kFault, label,
          fmt::format("{}; the log's mounting is off by {:+.2f} m, pitch {:+.2f} deg, roll {:+.2f} "
                      "deg about the "
                      "vehicle's axes: "
                      "corrected in site.ini",
                      found, m->height_error, degrees(m->pitch_error), degrees(m->roll_error)));
}

void addImages(Findings& out, const std::string& label, const SensorFacts& facts) {
  if (facts.unread_images > 0)
    out.add(Weight::kFault, label,
            fmt::format("{} of {} images have no file that can be read", facts.unread_images,
                        facts.frames));
}

void addNames(Findings& out, const std::string& label, const SensorFacts& facts) {
  std::string known, unknown;
  for (const auto& [name, count] : facts.names) {
    std::string& list = knownName(name).empty() ? unknown : known;
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", name, count);
  }
  if (!known.empty()) out.add(Weight::kFine, label, "classes " + known);
  if (!unknown.empty())
    out.add(Weight::kNote, label, "class names to add to `names` by hand: " + unknown);
  if (facts.high)
    out.add(Weight::kNote, label,
            fmt::format("scores {:.3g} to {:.3g} count as no evidence until perception-calibrate "
                        "detector has counted them",
                        *facts.low, *facts.high));
}

void addPoses(Findings& out, const LogSurvey& survey) {
  for (const auto& [label, poses] : survey.poses()) {
    double way = 0, fastest = 0, gap = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double step =
          (poses[i].T_world_ego.translation() - poses[i - 1].T_world_ego.translation()).norm();
      const double dt = poses[i].stamp - poses[i - 1].stamp;
      way += step, gap = std::max(gap, dt);
      if (dt > 0) fastest = std::max(fastest, step / dt);
    }
    const std::string text =
        fmt::format("{} poses, {:.1f} m driven, at most {:.1f} m/s, longest gap {:.2f} s",
                    poses.size(), way, fastest, gap);
    const bool jump = fastest > EgoPoseParams{}.max_speed;
    out.add(jump ? Weight::kFault : Weight::kFine, label.empty() ? "poses" : label,
            text + (jump ? ": jumps" : ""));
  }
  if (survey.poseFaults() > 0)
    out.add(Weight::kFault, "poses",
            fmt::format("{} without stamp or not finite", survey.poseFaults()));
  std::string motion;
  for (const auto& [what, count] : survey.motion())
    motion += fmt::format("{}{} ({})", motion.empty() ? "" : ", ", what, count);
  if (!motion.empty()) out.add(Weight::kFine, "ego motion", motion);
  if (motion.empty() && survey.poses().empty())
    out.add(Weight::kNote, "ego motion",
            "no poses, GNSS, inertial unit or wheels: odometry from the lidar ([ego] source = "
            "lidar), or, without a lidar, the vehicle is taken to stand still");
}

void addMissing(Findings& out, const LogSurvey& survey) {
  const auto has = [&](const char* kind) {
    return std::any_of(survey.sensors().begin(), survey.sensors().end(), [&](const auto& entry) {
      return entry.second.kind == kind && entry.second.frames > 0;
    });
  };
  const auto lack = [&out](const std::string& text) { out.add(Weight::kNote, "missing", text); };
  if (!has("lidar")) lack("no lidar: no free distance, no ground plane, no shapes of clusters");
  if (!has("boxes") && has("image"))
    lack("images without boxes: perception-detect writes boxes into the log");
  else if (!has("boxes"))
    lack("no image boxes: pedestrians and cyclists are named later and less surely");
  if (!has("radar")) lack("no radar: speeds come from positions alone");
  if (!has("lidar") && !has("boxes") && !has("radar") && !has("positions"))
    out.add(Weight::kFault, "missing", "no sensor that perception-track can use");
}

}  // namespace

void Findings::add(Finding::Weight weight, const std::string& about, const std::string& text) {
  all.push_back({weight, about, text});
}

std::vector<Finding> findingsOf(const LogSurvey& survey) {
  Findings out;
  for (const auto& [label, facts] : survey.sensors()) {
    const std::string about = label.empty() ? "(no label)" : label;
    if (label.empty() || label.find('.') != std::string::npos)
      out.add(Weight::kFault, about, "a label without a dot is needed for its section of the INI");
    addTiming(out, about, facts);
    addOrder(out, about, facts);
    addValues(out, about, facts);
    if (facts.frames == 0) continue;
    if (facts.kind == "lidar") addLidar(out, about, facts);
    if (facts.kind == "image") addImages(out, about, facts);
    if (facts.kind == "lidar" || facts.kind == "radar" || facts.kind == "image")
      addMotionFindings(survey, about, facts, out);
    if (facts.kind == "boxes" || facts.kind == "positions") addNames(out, about, facts);
  }
  addClocks(out, survey);
  addPoses(out, survey);
  addGnssFindings(survey, out);
  addMissing(out, survey);
  return out.all;
}

}  // namespace perception
