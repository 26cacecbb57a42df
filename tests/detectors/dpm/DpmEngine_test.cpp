#include "libperception/detectors/dpm/DpmEngine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <map>
#include <random>

#include "libperception/core/math/Angle.h"
#include "tests/detectors/dpm/DpmReference.h"

namespace perception::test {
namespace {

// A picture of bright and dark boxes on a slope of brightness, with noise: edges of all strengths,
// and nothing saturated (equal gradients in two channels are a matter of the last digit).
Raster picture(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Raster out;
  out.width = width;
  out.height = height;
  out.pixels.resize(static_cast<std::size_t>(width * height * 3));
  const auto number = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::vector<std::array<int, 7>> boxes;
  for (int i = 0; i < 14; ++i)
    boxes.push_back({number(width), number(height), 5 + number(width / 2), 5 + number(height / 2),
                     20 + number(200), 20 + number(200), 20 + number(200)});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        int value = 60 + 100 * x / width + number(12);
        for (const auto& b : boxes)
          if (x >= b[0] && x < b[0] + b[2] && y >= b[1] && y < b[1] + b[3])
            value = b[static_cast<std::size_t>(4 + c)] + number(12);
        out.pixels[static_cast<std::size_t>((y * width + x) * 3 + c)] =
            static_cast<std::uint8_t>(std::clamp(value, 0, 255));
      }
  return out;
}

DpmFilter filter(int height, int width, std::mt19937& random) {
  DpmFilter f{height, width, {}};
  for (int i = 0; i < height * width * 32; ++i)
    f.weights.push_back(0.2F * (static_cast<float>(random() % 2001) / 1000.F - 1.F));
  return f;
}

// Components of different sizes; parts with odd anchors and anchors beyond the root.
DpmModel tinyModel(unsigned seed) {
  std::mt19937 random(seed);
  DpmModel model;
  model.class_name = "thing";
  model.has_heading = true;
  const int sizes[3][2] = {{3, 4}, {5, 3}, {4, 4}};
  for (int k = 0; k < 3; ++k) {
    DpmComponent c;
    c.heading = k;
    c.offset = -0.3 * k;
    c.height = sizes[k][0];
    c.width = sizes[k][1];
    c.root = filter(c.height, c.width, random);
    for (int p = 0; p < 3 - k; ++p) {
      DpmPart part;
      part.filter = filter(3 + p, 4, random);
      part.anchor_x = static_cast<int>(random() % 7) - 1;
      part.anchor_y = static_cast<int>(random() % 7) - 2;
      part.deformation[0] = 0.02 + 0.01 * p;
      part.deformation[1] = 0.013;
      part.deformation[2] = 0.03;
      part.deformation[3] = -0.017 * p;
      c.parts.push_back(part);
    }
    model.components.push_back(c);
  }
  return model;
}

using PlaceKey = std::tuple<int, int, long, long, long>;  // target, component, corner, width

PlaceKey keyOf(const DpmDetection& d) {
  return {d.target, d.component, std::lround(d.box.x1 * 16), std::lround(d.box.y1 * 16),
          std::lround(d.box.x2 * 16)};
}

std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> out;
  for (SimdLevel l : {SimdLevel::kSse2, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (l <= simdLevel()) out.push_back(l);
  }
  return out;
}

// All places of one model by the literal detector.
std::map<PlaceKey, double> reference(const Raster& raster, const DpmModel& model,
                                     const DpmOptions& options) {
  std::map<PlaceKey, double> out;
  std::vector<ReferenceImage> octaves{referenceImage(raster)};
  std::vector<ReferenceHog> maps;
  const int interval = options.levels_per_octave;
  const int first = static_cast<int>(std::lround(std::log2(options.enlarge) * interval));
  for (int k = 0;; ++k) {
    const double scale = options.enlarge * std::pow(2.0, -static_cast<double>(k) / interval);
    const int width = static_cast<int>(std::lround(raster.width * scale));
    const int height = static_cast<int>(std::lround(raster.height * scale));
    if (std::min(width, height) < 5 * model.cell) break;
    const int octave = std::max(0, (k - first) / interval);
    while (octave >= static_cast<int>(octaves.size()))
      octaves.push_back(referenceHalved(octaves.back()));
    const auto image = referenceResampled(octaves[static_cast<std::size_t>(octave)], width, height);
    maps.emplace_back(image, model.cell);
    const ReferenceHog& roots = maps.back();
    const ReferenceHog parts = k < interval ? ReferenceHog(image, model.cell / 2)
                                            : maps[static_cast<std::size_t>(k - interval)];
    const double px = model.cell * static_cast<double>(raster.width) / width;
    const double py = model.cell * static_cast<double>(raster.height) / height;
    for (std::size_t c = 0; c < model.components.size(); ++c) {
      const DpmComponent& component = model.components[c];
      const int out_x = static_cast<int>(std::ceil(options.outside * component.root.width));
      const int out_y = static_cast<int>(std::ceil(options.outside * component.root.height));
      for (int y = -out_y; y + component.root.height <= roots.cellsY() + out_y; ++y)
        for (int x = -out_x; x + component.root.width <= roots.cellsX() + out_x; ++x) {
          DpmDetection d;
          d.component = static_cast<int>(c);
          d.box = {x * px, y * py, (x + component.width) * px, (y + component.height) * py};
          out[keyOf(d)] = referenceScore(roots, parts, component, x, y, options.window);
        }
    }
  }
  return out;
}

DpmTarget everywhere(DpmModel model) {
  DpmTarget t;
  t.model = std::move(model);
  t.threshold = -1e9;
  return t;
}

TEST(DpmEngine, ScoresEveryPlaceAsTheLiteralDetectorDoes) {
  const Raster image = picture(75, 61, 3);
  for (const double enlarge : {1.0, 2.0}) {
    DpmOptions options;
    options.levels_per_octave = 2;
    options.enlarge = enlarge;
    options.outside = 0.6;
    options.window = 3;
    const auto expected = reference(image, tinyModel(5), options);
    for (const SimdLevel level : levels()) {
      const DpmEngine engine({everywhere(tinyModel(5))}, options, level);
      const auto places = engine.places(image);
      ASSERT_EQ(places.size(), expected.size()) << nameOf(level);
      double worst = 0;
      for (const DpmDetection& d : places) {
        const auto found = expected.find(keyOf(d));
        ASSERT_NE(found, expected.end());
        worst = std::max(worst, std::abs(found->second - d.score));
      }
      EXPECT_LT(worst, 1e-4) << nameOf(level);
    }
  }
}

TEST(DpmEngine, AnOctavesOffsetGoesToTheScalesOfItsOctave) {
  const Raster image = picture(200, 170, 3);
  DpmOptions options;
  options.levels_per_octave = 2;
  options.enlarge = 2;
  DpmModel shifted = tinyModel(5);
  for (DpmComponent& c : shifted.components)
    c.octaves[0] = 0.1, c.octaves[1] = 0.2, c.octaves[2] = 0.4;
  std::map<PlaceKey, double> plain;
  for (const auto& d : DpmEngine({everywhere(tinyModel(5))}, options).places(image))
    plain[keyOf(d)] = d.score;
  std::array<int, 3> seen{};
  for (const auto& d : DpmEngine({everywhere(shifted)}, options).places(image)) {
    const auto& c = shifted.components[static_cast<std::size_t>(d.component)];
    const double scale = 8 * c.width / (d.box.x2 - d.box.x1);
    const std::size_t octave = scale > 1.01 ? 0 : scale > 0.51 ? 1 : 2;
    ++seen[octave];
    ASSERT_NEAR(d.score - plain.at(keyOf(d)), c.octaves[octave], 1e-5) << scale;
  }
  for (const int n : seen) EXPECT_GT(n, 0);
}

TEST(DpmEngine, SeveralModelsShareAPyramidAndChangeNothing) {
  const Raster image = picture(90, 70, 4);
  DpmOptions options;
  options.levels_per_octave = 3;
  const DpmEngine one({everywhere(tinyModel(5))}, options);
  const DpmEngine two({everywhere(tinyModel(9)), everywhere(tinyModel(5))}, options);
  std::map<PlaceKey, double> alone;
  for (const auto& d : one.places(image)) alone[keyOf(d)] = d.score;
  std::size_t compared = 0;
  for (auto d : two.places(image)) {
    if (d.target != 1) continue;
    d.target = 0;
    ASSERT_NEAR(alone.at(keyOf(d)), d.score, 1e-5);
    ++compared;
  }
  EXPECT_EQ(compared, alone.size());
}

TEST(DpmEngine, GroundLeavesOutWhatCannotStandAndChangesNoScore) {
  const Raster image = picture(160, 120, 6);
  GroundGate gate;
  gate.horizon = 40;
  gate.focal = 100;
  gate.height = 1.6;
  DpmOptions options;
  DpmTarget target = everywhere(tinyModel(5));
  target.low = 0.8;
  target.high = 2;
  const DpmEngine engine({target}, options);
  std::map<PlaceKey, double> admitted;
  for (const auto& d : engine.places(image))
    if (gate.admits(d.box.y1, d.box.y2, target.low, target.high)) admitted[keyOf(d)] = d.score;
  const auto gated = engine.places(image, {gate, false});
  ASSERT_EQ(gated.size(), admitted.size());
  ASSERT_GT(gated.size(), 100U);
  for (const auto& d : gated) ASSERT_NEAR(admitted.at(keyOf(d)), d.score, 1e-5);
}

TEST(DpmEngine, SameBytesForAnyNumberOfThreads) {
  const Raster image = picture(200, 120, 7);
  const DpmEngine engine({everywhere(tinyModel(5)), everywhere(tinyModel(2))}, {});
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return engine.places(image);
  };
  const auto one = run(1), four = run(4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].score, four[i].score);
    ASSERT_EQ(keyOf(one[i]), keyOf(four[i]));
  }
}

// A root that is what it looks for, cut out of the picture: found where it was cut, at its size.
TEST(DpmEngine, FindsWhatItWasCutFrom) {
  const Raster image = picture(240, 160, 8);
  const ReferenceHog hog(referenceImage(image), 8);
  DpmModel model;
  model.class_name = "patch";
  DpmComponent c;
  c.height = 6;
  c.width = 8;
  c.root = {6, 8, {}};
  double mean = 0;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x)
      for (const double f : hog.cell(9 + x, 7 + y)) {
        c.root.weights.push_back(static_cast<float>(f));
        mean += f;
      }
  mean /= static_cast<double>(c.root.weights.size());
  for (float& w : c.root.weights) w -= static_cast<float>(mean);
  model.components = {c};
  DpmTarget target = everywhere(model);
  target.threshold = 0;
  const DpmEngine engine({target}, {});
  const auto found = engine.detect(image);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].box.x1, 72, 1e-6);
  EXPECT_NEAR(found[0].box.y1, 56, 1e-6);
  EXPECT_NEAR(found[0].box.x2, 136, 1e-6);
  EXPECT_NEAR(found[0].box.y2, 104, 1e-6);
  EXPECT_FALSE(found[0].heading);
}

TEST(DpmModel, TextFormComesBackAsItWas) {
  const DpmModel model = tinyModel(5);
  const DpmModel again = parseDpmModel(test::dpmModelText(model), "text");
  ASSERT_EQ(again.components.size(), model.components.size());
  for (std::size_t k = 0; k < model.components.size(); ++k) {
    const DpmComponent &a = model.components[k], &b = again.components[k];
    EXPECT_EQ(a.root.weights, b.root.weights);
    EXPECT_EQ(a.offset, b.offset);
    ASSERT_EQ(a.parts.size(), b.parts.size());
    for (std::size_t p = 0; p < a.parts.size(); ++p) {
      EXPECT_EQ(a.parts[p].filter.weights, b.parts[p].filter.weights);
      EXPECT_EQ(a.parts[p].anchor_x, b.parts[p].anchor_x);
      EXPECT_EQ(a.parts[p].deformation[3], b.parts[p].deformation[3]);
    }
  }
}

TEST(DpmModel, SaysWhereATextIsWrong) {
  std::string text = test::dpmModelText(tinyModel(5));
  text.resize(text.size() / 2);
  try {
    parseDpmModel(text, "bank.txt");
    FAIL() << "half a bank was accepted";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("bank.txt:"), std::string::npos) << e.what();
  }
  EXPECT_THROW(readDpmModel("/nowhere/bank.txt"), DataError);
}

// The text export was made from the same file by other means.
TEST(DpmModel, MatlabFileAndTextExportAreOneModel) {
  const std::string folder = std::string(PERCEPTION_SHARED_DATA) + "/data/kitti_dpm_models/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no models in " << folder;
  const std::pair<const char*, const char*> files[] = {
      {"car_2_2012_10_04-20_13_57_model.mat", "car_orient16.txt.gz"},
      {"pedestrian_2_2012_10_04-20_25_13_model.mat", "pedestrian_orient8.txt.gz"}};
  for (const auto& [mat, text] : files) {
    const DpmModel a = readDpmModel(folder + mat), b = readDpmModel(folder + text);
    ASSERT_EQ(a.components.size(), b.components.size());
    EXPECT_NEAR(a.threshold, b.threshold, 1e-5);
    for (std::size_t k = 0; k < a.components.size(); ++k) {
      const DpmComponent &c = a.components[k], &d = b.components[k];
      EXPECT_NEAR(wrapAngle(c.heading - d.heading), 0, 1e-5);
      EXPECT_NEAR(c.offset, d.offset, 1e-6);
      ASSERT_EQ(c.parts.size(), d.parts.size());
      ASSERT_EQ(c.root.weights.size(), d.root.weights.size());
      for (std::size_t i = 0; i < c.root.weights.size(); ++i)
        ASSERT_NEAR(c.root.weights[i], d.root.weights[i], 1e-6);
      for (std::size_t p = 0; p < c.parts.size(); ++p) {
        EXPECT_EQ(c.parts[p].anchor_x, d.parts[p].anchor_x);
        EXPECT_NEAR(c.parts[p].deformation[2], d.parts[p].deformation[2], 1e-6);
        for (std::size_t i = 0; i < c.parts[p].filter.weights.size(); ++i)
          ASSERT_NEAR(c.parts[p].filter.weights[i], d.parts[p].filter.weights[i], 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace perception::test
