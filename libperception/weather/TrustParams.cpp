#include "libperception/weather/TrustParams.h"

namespace perception {
namespace {

struct CurveRow {
  TrustFeature feature;
  const char* key;
  const char* doc;
  std::vector<double> knots;
  std::vector<double> values;
};

const std::vector<CurveRow>& curveRows() {
  static const std::vector<CurveRow> rows = {
      {TrustFeature::kRange,
       "range_curve",
       "at 7, 9, 11, 13, 16, 20, 30 m",
       {7, 9, 11, 13, 16, 20, 30},
       {0, -0.36, -1.56, -3.28, -4.46, -5.99, -6.05}},
      {TrustFeature::kTight,
       "tight_curve",
       "at 0, 1, 2, 4, 8, 16 neighbors within `tight`",
       {0, 1, 2, 4, 8, 16},
       {0, 0, -0.33, -1.05, -2.04, -2.89}},
      {TrustFeature::kWide,
       "wide_curve",
       "at 0, 1, 2, 4, 8, 16, 30 neighbors within `wide`",
       {0, 1, 2, 4, 8, 16, 30},
       {0, -0.76, -1.46, -2.12, -2.87, -3.79, -4.71}},
      {TrustFeature::kBeyond,
       "beyond_curve",
       "at shares 0, .1, .3, .6, .9, 1 of the neighboring beams that pass behind",
       {0, 0.1, 0.3, 0.6, 0.9, 1},
       {0, 1.86, 1.90, 3.59, 4.11, 3.09}},
      {TrustFeature::kHeight,
       "height_curve",
       "at -.3, .3, 1, 1.6 m above the ground plane",
       {-0.3, 0.3, 1, 1.6},
       {0, 0.49, 1.11, 4.94}},
      {TrustFeature::kCompany,
       "company_curve",
       "at -4, -2, -1, 0, 1, 2, 4, 6: ln((1 + surfaces) / (1 + phantoms)) within half a meter",
       {-4, -2, -1, 0, 1, 2, 4, 6},
       {0, -2.61, -3.17, -4.37, -5.92, -7.61, -9.12, -9.30}},
  };
  return rows;
}

}  // namespace

TrustParams::TrustParams() {
  for (const CurveRow& row : curveRows())
    curves[static_cast<std::size_t>(row.feature)] = row.values;
}

const std::vector<double>& TrustParams::knotsOf(TrustFeature feature) {
  return curveRows()[static_cast<std::size_t>(feature)].knots;
}

void TrustParams::visit(ParamVisitor& v) {
  v.angle("column_deg", column, {0.05, 5}, "azimuth of a pixel of the range image");
  v.angle("row_deg", row, {0, 10}, "elevation of a pixel; 0: found from the first scan");
  v.real("max_range", max_range, {1, 200}, "m", "beyond it every return is trusted");
  v.real("tight", tight, {0.001, 0.5}, "", "of the range: a neighbor of the same surface");
  v.real("wide", wide, {0.001, 0.5}, "", "of the range: a neighbor");
  v.real("beyond", beyond, {0.001, 2}, "", "of the range: a beam that passes behind");
  v.integer("surface_neighbors", surface_neighbors, {1, 9},
            "of the eight nearest pixels within `tight` that make a surface");
  for (const CurveRow& row : curveRows())
    v.reals(row.key, curves[static_cast<std::size_t>(row.feature)],
            static_cast<int>(row.knots.size()), {-20, 20}, "log-odds", row.doc);
  v.real("bias", bias, {-20, 20}, "log-odds", "of the first pass");
  v.real("gain", gain, {0, 5}, "", "of the first pass in the second");
  v.real("second_bias", second_bias, {-20, 20}, "log-odds", "of the second pass");
  v.boolean("use_intensity", use_intensity, "learn which intensities phantoms have");
  v.real("intensity_gain", intensity_gain, {0, 5}, "", "of the learned log-likelihood ratio");
  v.real("intensity_memory", intensity_memory, {1, 1e4}, "scans", "of the learned intensities");
  v.boolean("adapt_share", adapt_share, "let the share of phantoms follow the weather");
  v.real("fitted_share", fitted_share, {1e-4, 0.9}, "",
         "of phantoms within share_range in the scans that the curves were fitted to");
  v.real("share_range", share_range, {1, 200}, "m", "within which phantoms are counted");
  v.real("share_memory", share_memory, {1, 1e4}, "scans", "of the share of phantoms");
  v.real("share_gain", share_gain, {0, 2}, "", "of the change of log-odds that the share makes");
  v.real("least_share", least_share, {1e-6, 0.5}, "", "of phantoms in clear air");
  v.real("sensor_label", sensor_label, {0, 20}, "log-odds", "the sensor says rain or dirt");
  v.real("rain_rule", rain_rule, {0, 20}, "log-odds",
         "a first echo that is weaker or shorter than the second (paper)");
}

}  // namespace perception
