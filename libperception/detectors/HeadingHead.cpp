#include "libperception/detectors/HeadingHead.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/VisionSimd.h"

namespace perception {
namespace {

constexpr int kColumns = 10, kRows = 6, kCell = 8;  // of the box; plus a cell at each side
constexpr std::size_t kValues = kColumns * kRows * (kHogFeatures - 1) + 1;  // plus the aspect ratio
constexpr double kBin = kTwoPi / HeadingHead::kBins;
constexpr double kSpread = radians(20);  // [rad] of the target over the orientations
constexpr double kRidge = 2;             // in units of a descriptor's mean square
constexpr const char* kTitle = "heading_head 1";

/// Crops the box plus a cell around it; columns wrap in a panorama, otherwise the border is
/// replicated.
Raster cut(const Raster& image, const ObjectDetection::ImageBox& b, bool closed, bool mirrored) {
  const double mx = (b.x2 - b.x1) / kColumns, my = (b.y2 - b.y1) / kRows;
  const int x0 = static_cast<int>(std::lround(b.x1 - mx)),
            x1 = static_cast<int>(std::lround(b.x2 + mx)),
            y0 = static_cast<int>(std::lround(b.y1 - my)),
            y1 = static_cast<int>(std::lround(b.y2 + my));
  Raster out;
  out.width = std::max(4, x1 - x0);
  out.height = std::max(4, y1 - y0);
  out.channels = image.channels;
  for (int y = 0; y < out.height; ++y) {
    const int v = std::clamp(y0 + y, 0, image.height - 1);
    for (int x = 0; x < out.width; ++x) {
      const int column = x0 + (mirrored ? out.width - 1 - x : x);
      const int u = closed ? ((column % image.width) + image.width) % image.width
                           : std::clamp(column, 0, image.width - 1);
      const auto* from = image.pixels.data() + (static_cast<long>(v) * image.width + u) *
                                                   static_cast<long>(image.channels);
      out.pixels.insert(out.pixels.end(), from, from + image.channels);
    }
  }
  return out;
}

/// Regression target: a Gaussian over the orientations, centered at the heading.
Eigen::RowVectorXf target(double heading) {
  Eigen::RowVectorXf t(HeadingHead::kBins);
  for (int k = 0; k < HeadingHead::kBins; ++k) {
    const double d = wrapAngle(heading - k * kBin);
    t[k] = static_cast<float>(std::exp(-0.5 * d * d / (kSpread * kSpread)));
  }
  return t;
}

std::string nextWord(std::istream& in, const std::string& path, const char* expected) {
  std::string word;
  if (!(in >> word)) throw DataError(fmt::format("{}: expected {}", path, expected));
  return word;
}

double nextNumber(std::istream& in, const std::string& path, const char* expected) {
  const std::string word = nextWord(in, path, expected);
  try {
    std::size_t used = 0;
    const double value = std::stod(word, &used);
    if (used == word.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  throw DataError(fmt::format("{}: found '{}', expected {}", path, word, expected));
}

}  // namespace

void HeadingHeadParams::visit(ParamVisitor& v) {
  v.expert();
  v.path("file", file, "of a head, as written by perception-detect --train-heading");
  v.boolean("replace", replace, "replace the headings of the detector");
}

std::vector<float> HeadingHead::describe(const Raster& image, const ObjectDetection::ImageBox& box,
                                         bool closed, bool mirrored) {
  if (!(box.x2 - box.x1 >= 2) || !(box.y2 - box.y1 >= 2) || image.width < 4 || image.height < 4)
    return {};
  const VisionKernels& kernels = visionKernels(simdLevel());
  constexpr int kWidth = (kColumns + 2) * kCell, kHeight = (kRows + 2) * kCell;
  PlanarImage pixels = planarImage(cut(image, box, closed, mirrored));
  while (pixels.width > 2 * kWidth && pixels.height > 2 * kHeight) pixels = halved(pixels);
  // Halve first: area averaging spans at most three pixels.
  while (pixels.width > 2 * kWidth || pixels.height > 2 * kHeight)
    pixels = resampled(pixels, std::max(kWidth, (pixels.width + 1) / 2),
                       std::max(kHeight, (pixels.height + 1) / 2),
                       {0, std::max(kHeight, (pixels.height + 1) / 2)}, kernels);
  const PlanarImage fixed = resampled(pixels, kWidth, kHeight, {0, kHeight}, kernels);
  const auto maps = hogFeatures(fixed, {{kCell, {1, kColumns + 1}, {1, kRows + 1}}}, kernels);
  std::vector<float> out;
  out.reserve(kValues);
  for (int y = 1; y <= kRows; ++y) {
    for (int x = 1; x <= kColumns; ++x) {
      const float* cell = maps[0].cell(x, y);
      out.insert(out.end(), cell, cell + kHogFeatures - 1);
    }
  }
  out.push_back(static_cast<float>(std::log((box.x2 - box.x1) / (box.y2 - box.y1))));
  return out;
}

int HeadingHead::binOf(double heading) {
  return ((static_cast<int>(std::lround(heading / kBin)) % kBins) + kBins) % kBins;
}

void HeadingHead::fit(const std::vector<HeadingExample>& examples, int left_out) {
  std::vector<const HeadingExample*> used;
  for (const HeadingExample& e : examples) {
    if (e.fold != left_out) used.push_back(&e);
  }
  const auto n = static_cast<Eigen::Index>(used.size());
  const auto width = static_cast<Eigen::Index>(kValues);
  Eigen::MatrixXf X(n, width), T(n, Eigen::Index{kBins});
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& e = *used[static_cast<std::size_t>(i)];
    X.row(i) = Eigen::Map<const Eigen::RowVectorXf>(e.features.data(), width);
    T.row(i) = target(e.heading);
  }
  const Eigen::RowVectorXf mean_x = X.colwise().mean(), mean_t = T.colwise().mean();
  X.rowwise() -= mean_x;
  T.rowwise() -= mean_t;
  // Fewer examples than features: the dual form of ridge regression.
  Eigen::MatrixXf gram = X * X.transpose();
  const float scale = gram.trace() / static_cast<float>(std::max<Eigen::Index>(n, 1));
  gram.diagonal().array() += static_cast<float>(kRidge) * scale;
  const Eigen::MatrixXf W = X.transpose() * gram.ldlt().solve(T);  // values x bins
  const Eigen::RowVectorXf constant = mean_t - mean_x * W;
  weights_.assign((kValues + 1) * kBins, 0.F);
  for (int k = 0; k < kBins; ++k) {
    float* row = weights_.data() + static_cast<std::size_t>(k) * (kValues + 1);
    for (Eigen::Index i = 0; i < width; ++i) row[i] = W(i, k);
    row[width] = constant[k];
  }
}

HeadingHead HeadingHead::train(std::string label, const std::vector<HeadingExample>& examples) {
  std::set<int> folds;
  for (const HeadingExample& e : examples) folds.insert(e.fold);
  if (examples.size() < 2 * kBins || folds.size() < 2)
    throw DataError(fmt::format("{} pictures of '{}' in {} groups: too few to learn headings from",
                                examples.size(), label, folds.size()));
  HeadingHead head;
  head.label_ = std::move(label);
  double squares = 0;
  int flips = 0;
  std::array<int, kBins> rows{};
  for (const int fold : folds) {
    head.fit(examples, fold);
    for (const HeadingExample& e : examples) {
      if (e.fold != fold) continue;
      const double predicted = head.heading(e.features);
      double error = std::abs(wrapAngle(predicted - e.heading));
      if (error > kPi / 2) {
        ++flips;
        error = kPi - error;
      }
      squares += error * error;
      const auto truth = static_cast<std::size_t>(binOf(e.heading));
      head.confusion_[truth][static_cast<std::size_t>(binOf(predicted))] += 1;
      ++rows[truth];
    }
  }
  for (std::size_t k = 0; k < kBins; ++k) {
    for (double& share : head.confusion_[k]) share /= std::max(1, rows[k]);
  }
  head.examples_ = static_cast<int>(examples.size());
  head.axis_sigma_ = std::sqrt(squares / head.examples_);
  head.flip_share_ = static_cast<double>(flips) / head.examples_;
  head.fit(examples, -1);
  return head;
}

double HeadingHead::heading(const std::vector<float>& features) const {
  std::array<double, kBins> score{};
  for (int k = 0; k < kBins; ++k) {
    const float* row = weights_.data() + static_cast<std::size_t>(k) * (kValues + 1);
    score[static_cast<std::size_t>(k)] = static_cast<double>(
        std::inner_product(features.begin(), features.end(), row, row[kValues]));
  }
  const auto best =
      static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin());
  // Maximum of the parabola through the best orientation and its neighbors.
  const double a = score[(best + kBins - 1) % kBins], b = score[best],
               c = score[(best + 1) % kBins];
  const double bend = a - 2 * b + c;
  const double shift = bend < 0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0;
  return wrapAngle((static_cast<double>(best) + shift) * kBin);
}

void HeadingHead::apply(const Raster& image, bool closed, bool replace,
                        std::vector<ObjectDetection>& objects) const {
  for (ObjectDetection& o : objects) {
    if (o.label != label_ || !o.image_box || (o.heading && !replace)) continue;
    const auto features = describe(image, *o.image_box, closed);
    if (!features.empty()) o.heading = heading(features);
  }
}

std::string HeadingHead::text() const {
  std::string out = fmt::format(
      "{}\nlabel {}\nexamples {}\naxis_sigma_deg {:.4f}\nflip_share {:.5f}\nconfusion {}\n", kTitle,
      label_, examples_, degrees(axis_sigma_), flip_share_, kBins);
  for (const auto& row : confusion_) {
    for (std::size_t k = 0; k < kBins; ++k)
      out += fmt::format("{:.4f}{}", row[k], k + 1 < kBins ? ' ' : '\n');
  }
  out += fmt::format("weights {} {}\n", kBins, kValues + 1);
  for (std::size_t i = 0; i < weights_.size(); ++i)
    out += fmt::format("{:.6g}{}", weights_[i], (i + 1) % (kValues + 1) == 0 ? '\n' : ' ');
  return out;
}

HeadingHead HeadingHead::read(const std::string& path) {
  std::ifstream in(path);
  if (!in)
    throw DataError(fmt::format("{}: no such file (a heading head)", path), ExitCode::kNoInput);
  const auto key = [&](const char* name) {
    if (nextWord(in, path, name) != name)
      throw DataError(fmt::format("{}: expected '{}'", path, name));
  };
  HeadingHead head;
  key("heading_head");
  if (nextNumber(in, path, "version") != 1)
    throw DataError(fmt::format("{}: a heading head of another version", path));
  key("label");
  head.label_ = nextWord(in, path, "label");
  key("examples");
  head.examples_ = static_cast<int>(nextNumber(in, path, "number of examples"));
  key("axis_sigma_deg");
  head.axis_sigma_ = radians(nextNumber(in, path, "an angle"));
  key("flip_share");
  head.flip_share_ = nextNumber(in, path, "a share");
  key("confusion");
  if (nextNumber(in, path, "16 orientations") != kBins)
    throw DataError(fmt::format("{}: expected 16 orientations", path));
  for (auto& row : head.confusion_) {
    for (double& share : row) share = nextNumber(in, path, "a share");
  }
  key("weights");
  if (nextNumber(in, path, "16 orientations") != kBins ||
      nextNumber(in, path, "values of a descriptor") != kValues + 1)
    throw DataError(fmt::format("{}: expected 16 x {} weights", path, kValues + 1));
  head.weights_.resize((kValues + 1) * kBins);
  for (float& w : head.weights_) w = static_cast<float>(nextNumber(in, path, "a weight"));
  return head;
}

}  // namespace perception
