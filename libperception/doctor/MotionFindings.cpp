#include "libperception/doctor/MotionFindings.h"

#include <fmt/format.h>

#include <utility>

namespace perception {
namespace {

using Weight = Finding::Weight;

/// "yaw +5.0 +- 0.1 deg" of those that are `wrong`, or of all that are observed.
std::string valuesText(const MotionCheck& check, bool (MotionCheck::Value::*which)() const) {
  std::string text;
  const auto add = [&](const char* name, const MotionCheck::Value& v, double unit,
                       const char* unit_name) {
    if ((v.*which)())
      text += fmt::format("{}{} {:+.2f} +- {:.2f} {}", text.empty() ? "" : ", ", name,
                          v.error / unit, v.sigma / unit, unit_name);
  };
  add("yaw", check.yaw, radians(1), "deg"), add("pitch", check.pitch, radians(1), "deg");
  add("roll", check.roll, radians(1), "deg");
  add("ahead", check.ahead, 1, "m"), add("left", check.left, 1, "m");
  add("clock", check.clock, 1e-3, "ms late");
  return text;
}

std::string unseenText(const MotionCheck& check) {
  std::string text;
  const std::pair<const char*, const MotionCheck::Value*> all[] = {
      {"yaw", &check.yaw},     {"pitch", &check.pitch}, {"roll", &check.roll},
      {"ahead", &check.ahead}, {"left", &check.left},   {"clock", &check.clock}};
  for (const auto& [name, value] : all)
    if (!value->observable()) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

/// `what` was compared, what the drive does not show, and what to do about wrong values.
void addCheck(Findings& out, const std::string& about, const MotionCheck& check,
              const std::string& what, const std::string& unseen, const std::string& remedy) {
  const std::string seen = valuesText(check, &MotionCheck::Value::observable),
                    wrong = valuesText(check, &MotionCheck::Value::isWrong);
  if (!seen.empty()) out.add(Weight::kFine, about, what + ": " + seen);
  if (!unseen.empty())
    out.add(Weight::kNote, about, "not observable against the poses on this drive: " + unseen);
  if (!wrong.empty())
    out.add(Weight::kFault, about, "off against the poses: " + wrong + "; " + remedy);
}

}  // namespace

void addMotionFindings(const LogSurvey& survey, const std::string& about, const SensorFacts& facts,
                       Findings& out) {
  if (survey.referencePoses() == nullptr || facts.planar) return;
  const auto check = survey.motionCheck(facts);
  if (!check)
    return out.add(
        Weight::kNote, about,
        "mounting and clock against the poses not observable: too few scans while driving");
  addCheck(out, about, *check,
           fmt::format("error of mounting and clock by its own motion against the poses' "
                       "({} scans)",
                       check->used),
           unseenText(*check),
           check->clock.isWrong() ? "stamps must be corrected when the log is written, "
                                    "mountings are corrected in site.ini"
                                  : "corrected in site.ini");
}

void addGnssFindings(const LogSurvey& survey, Findings& out) {
  const auto* poses = survey.referencePoses();
  if (poses == nullptr) return;
  for (const auto& [label, facts] : survey.gnss()) {
    const auto check = checkGnssMotion(facts.fixes, facts.antenna, *poses);
    if (!check) {
      out.add(Weight::kNote, label,
              "clock and antenna against the poses not observable: too few fixes while driving");
      continue;
    }
    std::string unseen;
    for (const auto& [name, value] : {std::pair("antenna ahead", &check->ahead),
                                      {"antenna left", &check->left},
                                      {"clock", &check->clock}})
      if (!value->observable())
        unseen += fmt::format("{}{} (+- {:.2g} {})", unseen.empty() ? "" : ", ", name,
                              value->sigma / (value == &check->clock ? 1e-3 : 1),
                              value == &check->clock ? "ms" : "m");
    addCheck(out, label, *check,
             fmt::format("error of clock and antenna against the poses ({} differences of fixes)",
                         check->used),
             unseen, "must be corrected when the log is written, or where the poses are made");
  }
}

}  // namespace perception
