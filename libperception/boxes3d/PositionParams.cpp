#include "libperception/boxes3d/PositionParams.h"

#include <algorithm>

namespace perception {
namespace {

/// "Car=car" -> its two words; empty when it is not of that form.
std::pair<std::string, std::string> splitName(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return {};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace

void PositionParams::visit(ParamVisitor& v) {
  v.words("labels", labels, "labels of the measurements: columns of the class tables");
  v.require(!labels.empty(), "labels: at least one");
  v.words("names", names, "the detector's class names and their labels: Car=car ...");
  for (const auto& n : names) {
    const auto [name, label] = splitName(n);
    v.require(std::find(labels.begin(), labels.end(), label) != labels.end(),
              "names: '" + n + "' is not NAME=LABEL with one of the labels");
  }
  const auto table = [&](const char* prefix, Table& rows, const char* unit, const char* text) {
    v.table(prefix, rows, {-1e9, 1e9}, unit, text);
    for (const auto& row : rows) {
      v.require(std::find(labels.begin(), labels.end(), row.first) != labels.end(),
                prefix + row.first + ": no such label");
    }
  };
  v.real("sigma", sigma, {0.001, 1e3}, "m", "noise of the center, each axis");
  v.real("range_share", range_share, {0, 1}, "", "share of the range added to sigma");
  v.real("clutter_sigma_growth", clutter_sigma_growth, {0, 100}, "",
         "relative growth of both for a box that is clutter by its score");
  v.choiceOf("confidence", confidence, {"fixed", "learnt", "fitted"},
             "how scores are evidence: keys score_*, which fitted requires; or learned at work");
  table("score_slope.", score_slope, "1/score",
        "by label: P(object | score) = 1 / (1 + exp(-slope (score - offset) + fade range)); none: "
        "scores are no evidence");
  table("score_offset.", score_offset, "", "... score of even odds at range 0");
  table("score_fade.", score_fade, "1/m", "... decrease of the log-odds with range");
  table("score_balance.", score_balance, "",
        "... log of objects / clutter in the recordings of the fit");
  v.require(confidence != Confidence::kFitted || !score_slope.empty(),
            "confidence = fitted: no score_slope.LABEL; perception-calibrate confidence finds it");
  v.real("group_distance", group_distance, {0, 10}, "m",
         "boxes of different labels closer than this are of one object; 0: off");
  v.boolean("sizes", sizes, "length, width, height and direction of the boxes are measured, too");
  v.angle("axis_sigma_deg", axis_sigma, {0.1, 90}, "noise of that direction as an axis");
  v.real("heading_flip", heading_flip, {0, 0.5}, "", "share of reversed directions");
  v.real("length_sigma", length_sigma, {0.001, 10}, "m", "noise of a box's length");
  v.real("width_sigma", width_sigma, {0.001, 10}, "m", "noise of a box's width");
  v.real("height_sigma", height_sigma, {0.001, 10}, "m", "noise of a box's height");
  v.real("base_sigma", base_sigma, {0.001, 10}, "m", "noise of the height of a box's lower face");
  table("length_excess.", length_excess, "m", "bias of the length of a label's boxes");
  table("width_excess.", width_excess, "m", "... too wide");
  table("height_excess.", height_excess, "m", "... too high");
  v.expert();
  v.real("min_score", min_score, {-1e9, 1e9}, "", "boxes below are dropped");
  v.real("off_label_score_weight", off_label_score_weight, {0, 1}, "",
         "weight of that evidence for classes that the label does not name");
}

std::map<std::string, int> PositionParams::labelOf() const {
  std::map<std::string, int> indices;
  for (const std::string& n : names) {
    const auto [name, label] = splitName(n);
    indices[name] =
        static_cast<int>(std::find(labels.begin(), labels.end(), label) - labels.begin());
  }
  return indices;
}

}  // namespace perception
