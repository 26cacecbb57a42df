#include "libperception/detectors/dpm/DpmMatFile.h"

#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>
#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/detectors/dpm/DpmModel.h"
#include "tests/support/DpmText.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

constexpr std::size_t kRoot[2] = {3, 4}, kPart[2] = {2, 2};  // [cells] rows, columns

// MATLAB's values, built from the inside out.
matvar_t* numbers(const char* name, std::vector<double> values,
                  std::vector<std::size_t> dims = {}) {
  if (dims.empty()) dims = {1, values.size()};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(dims.size()), dims.data(),
                       values.data(), 0);
}
matvar_t* text(const char* name, std::string value) {
  std::size_t dims[2] = {1, value.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UINT8, 2, dims, value.data(), 0);
}
/// A struct array: one inner list an element, fields in one order.
matvar_t* structs(const char* name, const std::vector<std::vector<matvar_t*>>& elements) {
  std::vector<std::string> names;  // copies: setting a field gives its variable another name
  for (const matvar_t* v : elements[0]) names.emplace_back(v->name);
  std::vector<const char*> fields;
  for (const auto& n : names) fields.push_back(n.c_str());
  std::size_t dims[2] = {1, elements.size()};
  matvar_t* out =
      Mat_VarCreateStruct(name, 2, dims, fields.data(), static_cast<unsigned>(fields.size()));
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (std::size_t f = 0; f < fields.size(); ++f)
      Mat_VarSetStructFieldByName(out, fields[f], i, elements[i][f]);
  return out;
}
matvar_t* cells(const char* name, std::vector<matvar_t*> values) {
  std::size_t dims[2] = {1, values.size()};
  return Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, dims, values.data(), 0);
}
void writeAndFree(const std::string& path, matvar_t* variable) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE);
  Mat_Close(file);
  Mat_VarFree(variable);
}

std::vector<double> weights(const std::size_t (&size)[2], double seed) {
  std::vector<double> w(size[0] * size[1] * 32);
  for (std::size_t i = 0; i < w.size(); ++i) w[i] = std::sin(seed + 0.37 * static_cast<double>(i));
  return w;
}
std::vector<std::size_t> volume(const std::size_t (&size)[2]) { return {size[0], size[1], 32}; }

/// One component with two parts, the second a mirrored copy of the first in release 5. Release 4
/// keeps weights beside what they belong to, release 5 in numbered blocks, offsets in units of
/// features.bias.
std::string writeModel(const TemporaryFolder& folder, int release) {
  const bool blocks = release == 5;
  const std::vector<double> deformation = {0.1, 0.02, 0.3, -0.04};
  const auto value = [&](double block, const std::vector<double>& w,
                         std::vector<std::size_t> dims = {}) {
    return blocks ? numbers("blocklabel", {block}) : numbers("w", w, std::move(dims));
  };
  const auto flip = [](double f) { return numbers("flip", {f}); };
  const auto size = [](const std::size_t(&s)[2]) {
    return numbers("size", {static_cast<double>(s[0]), static_cast<double>(s[1])});
  };
  matvar_t* filters =
      structs("filters", {{value(1, weights(kRoot, 1), volume(kRoot)), size(kRoot), flip(0)},
                          {value(2, weights(kPart, 2), volume(kPart)), size(kPart), flip(0)},
                          {value(2, weights(kPart, 2), volume(kPart)), size(kPart), flip(1)}});
  // Symbols: 1 start, 2 to 4 the filters, 5 and 6 the parts that may move.
  std::vector<std::vector<matvar_t*>> symbols;
  for (const double f : {0., 1., 2., 3., 0., 0.}) symbols.push_back({numbers("filter", {f})});
  const auto moving = [&](double filter_symbol, double mirrored) {
    return structs("", {{text("type", "D"), numbers("rhs", {filter_symbol}),
                         structs("def", {{value(3, deformation), flip(mirrored)}})}});
  };
  std::vector<matvar_t*> rule = {
      text("type", "S"), numbers("rhs", {2, 5, 6}), numbers("detwindow", {3, 4}),
      cells("anchor", {numbers("", {0, 0, 0}), numbers("", {1, 2, 1}), numbers("", {5, 3, 1})}),
      structs("offset", {{value(4, {-0.7})}})};
  if (blocks) rule.push_back(structs("loc", {{numbers("blocklabel", {5})}}));
  matvar_t* start = structs("", {rule});
  const auto nothing = [] { return numbers("", {}, {0, 0}); };
  std::vector<matvar_t*> fields = {
      text("class", "board"),
      numbers("sbin", {8}),
      numbers("thresh", {-0.5}),
      numbers("start", {1}),
      filters,
      structs("symbols", symbols),
      cells("rules", {start, nothing(), nothing(), nothing(), moving(3, 0), moving(4, 1)})};
  if (blocks) {
    fields.push_back(structs("blocks", {{numbers("w", weights(kRoot, 1))},
                                        {numbers("w", weights(kPart, 2))},
                                        {numbers("w", deformation)},
                                        {numbers("w", {-0.07})},
                                        {numbers("w", {-0.3, 0.02, 0.05})}}));
    fields.push_back(structs("features", {{numbers("bias", {10})}}));
  }
  matvar_t* model = structs("model", {fields});
  const std::string path = folder / ("release" + std::to_string(release) + ".mat");
  writeAndFree(path, model);
  return path;
}

/// No file of release 5 is public with a license to ship: these are written by this test, after the
/// layout that its sources (model_*.m, flipfeat.m) describe.
TEST(DpmMatFile, ReleasesFourAndFiveGiveOneModel) {
  const TemporaryFolder folder;
  const DpmModel four = readDpmModel(writeModel(folder, 4));
  const DpmModel five = readDpmModel(writeModel(folder, 5));
  for (const DpmModel& m : {four, five}) {
    EXPECT_EQ(m.class_name, "board");
    EXPECT_EQ(m.threshold, -0.5);
    ASSERT_EQ(m.components.size(), 1U);
    const DpmComponent& c = m.components[0];
    EXPECT_NEAR(c.offset, -0.7, 1e-12);  // release 5: -.07 times a bias of 10
    EXPECT_EQ(c.height, 3);
    EXPECT_EQ(c.width, 4);
    ASSERT_EQ(c.parts.size(), 2U);
    EXPECT_EQ(c.parts[0].anchor_x, 1);
    EXPECT_EQ(c.parts[1].anchor_y, 3);
    // Rows are fastest in MATLAB, features in ours: row 2, column 3, feature 5 of the root.
    EXPECT_NEAR(c.root.weights[(2 * 4 + 3) * 32 + 5], weights(kRoot, 1)[(5 * 4 + 3) * 3 + 2], 1e-6);
  }
  EXPECT_EQ(four.components[0].root.weights, five.components[0].root.weights);
  EXPECT_EQ(four.components[0].parts[0].filter.weights, five.components[0].parts[0].filter.weights);
}

TEST(DpmMatFile, IsReadAsDataOfOthers) {
  const TemporaryFolder folder;
  const std::string path = writeModel(folder, 5);
  const auto& record = SupervisionRecord::ofThisProcess();
  const auto before = record.reading.load();
  readDpmModel(path);
  EXPECT_EQ(record.reading, before + 2) << "a scope that was entered and left";
  EXPECT_EQ(std::string(record.read_from.data()), path);
}

TEST(DpmMatFile, ReleaseFiveWeighsTheOctaveOfTheRoot) {
  const TemporaryFolder folder;
  const DpmModel four = readDpmModel(writeModel(folder, 4));
  for (const double o : four.components[0].octaves) EXPECT_EQ(o, 0);
  const DpmModel five = readDpmModel(writeModel(folder, 5));
  EXPECT_EQ(five.components[0].octaves[0], -0.3);
  EXPECT_EQ(five.components[0].octaves[1], 0.02);
  EXPECT_EQ(five.components[0].octaves[2], 0.05);
  const DpmModel again = parseDpmModel(test::dpmModelText(five), "text");
  EXPECT_EQ(again.components[0].octaves[2], 0.05);
}

TEST(DpmMatFile, AMirroredBlockOfReleaseFiveIsTurnedRound) {
  const TemporaryFolder folder;
  const DpmModel model = readDpmModel(writeModel(folder, 5));
  const DpmPart &part = model.components[0].parts[0], &mirror = model.components[0].parts[1];
  EXPECT_EQ(mirror.deformation[1], -part.deformation[1]);
  EXPECT_EQ(mirror.deformation[3], part.deformation[3]);
  for (std::size_t y = 0; y < kPart[0]; ++y) {
    for (std::size_t x = 0; x < kPart[1]; ++x) {
      const float* from = &part.filter.weights[(y * 2 + x) * 32];
      const float* to = &mirror.filter.weights[(y * 2 + 1 - x) * 32];
      for (int k = 0; k < 18; ++k)  // contrast sensitive: direction k becomes 180 deg - k
        EXPECT_EQ(to[k], from[k <= 9 ? 9 - k : 27 - k]) << k;
      for (int k = 18; k < 27; ++k) EXPECT_EQ(to[k], from[k == 18 ? 18 : 45 - k]) << k;
      EXPECT_EQ(to[31], from[31]);
    }
  }
}

TEST(DpmMatFile, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  const std::string path = folder / "empty.mat";
  writeAndFree(path, structs("model", {{text("class", "x"), numbers("sbin", {8})}}));
  try {
    readDpmModel(path);
    FAIL() << "a model without filters was read";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("missing"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace perception::test
