#include "libperception/weather/trust/TrustParams.h"

namespace perception {
namespace {

struct CurveRow {
  TrustFeature feature;
  std::vector<double> knots;
  std::vector<double> values;
};

const std::vector<CurveRow>& curveRows() {
  static const std::vector<CurveRow> rows = {
      {TrustFeature::kRange,
       {7, 9, 11, 13, 16, 20, 30},
       {0, -0.36, -1.56, -3.28, -4.46, -5.99, -6.05}},
      {TrustFeature::kTight, {0, 1, 2, 4, 8, 16}, {0, 0, -0.33, -1.05, -2.04, -2.89}},
      {TrustFeature::kWide, {0, 1, 2, 4, 8, 16, 30}, {0, -0.76, -1.46, -2.12, -2.87, -3.79, -4.71}},
      {TrustFeature::kBeyond, {0, 0.1, 0.3, 0.6, 0.9, 1}, {0, 1.86, 1.90, 3.59, 4.11, 3.09}},
      {TrustFeature::kHeight, {-0.3, 0.3, 1, 1.6}, {0, 0.49, 1.11, 4.94}},
      {TrustFeature::kSurroundings,
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
  v.expert();
  v.real("max_range", max_range, {1, 200}, "m", "beyond it every return is trusted");
  v.boolean("use_intensity", use_intensity, "learn the intensities of phantoms");
}

}  // namespace perception
