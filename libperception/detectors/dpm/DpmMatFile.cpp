#include "libperception/detectors/dpm/DpmMatFile.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/core/system/MemoryLimit.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/detectors/simd/VisionKernels.h"

namespace perception {
namespace {

constexpr std::uint64_t kLargestModel = 512ULL << 20;  // [bytes] that reading may take; assumed

// Permutation of the features of a cell under mirroring (voc-release5, flipfeat.m).
constexpr std::array<int, kHogFeatures> kMirrored = {9,  8,  7,  6,  5,  4,  3,  2,  1,  0,  17,
                                                     16, 15, 14, 13, 12, 11, 10, 18, 26, 25, 24,
                                                     23, 22, 21, 20, 19, 29, 30, 27, 28, 31};

/// The variable `model` of a MATLAB file, read field by field.
class MatModel {
 public:
  explicit MatModel(const std::string& path) : path_(path), scope_(path) {
    if (!std::filesystem::exists(path))
      throw DataError(fmt::format("{}: no such file (a part model)", path), ExitCode::kNoInput);
    file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (!file_) throw DataError(fmt::format("{}: not a MATLAB file", path));
    model_.reset(Mat_VarRead(file_.get(), "model"));
    if (!model_ || model_->class_type != MAT_C_STRUCT)
      throw DataError(fmt::format("{}: expected a structure named 'model'", path));
  }
  const matvar_t* root() const { return model_.get(); }

  [[noreturn]] void fail(const std::string& what) const {
    throw DataError(fmt::format("{}: model{}", path_, what));
  }
  const matvar_t* find(const matvar_t* parent, const char* name, std::size_t index = 0) const {
    if (parent == nullptr || parent->class_type != MAT_C_STRUCT || index >= count(parent))
      return nullptr;
    return Mat_VarGetStructFieldByName(const_cast<matvar_t*>(parent), name, index);
  }
  const matvar_t* field(const matvar_t* parent, const char* name, std::size_t index = 0) const {
    const matvar_t* v = find(parent, name, index);
    if (v == nullptr) fail(fmt::format(".{}: missing", name));
    return v;
  }
  const matvar_t* cell(const matvar_t* cells, std::size_t index) const {
    if (cells->class_type != MAT_C_CELL || index >= count(cells)) fail(": a list is too short");
    return Mat_VarGetCell(const_cast<matvar_t*>(cells), static_cast<int>(index));
  }
  static std::size_t count(const matvar_t* v) {
    std::size_t n = v->rank > 0 ? 1 : 0;
    for (int i = 0; i < v->rank; ++i) n *= v->dims[i];
    return n;
  }
  std::vector<double> numbers(const matvar_t* v, const char* what) const {
    const std::size_t n = count(v);
    if (n > 0 && v->data == nullptr) fail(fmt::format(".{}: without its values", what));
    std::vector<double> out(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (v->class_type == MAT_C_DOUBLE) {
        out[i] = static_cast<const double*>(v->data)[i];
      } else if (v->class_type == MAT_C_SINGLE) {
        out[i] = static_cast<double>(static_cast<const float*>(v->data)[i]);
      } else if (v->class_type == MAT_C_UINT8) {
        out[i] = static_cast<const std::uint8_t*>(v->data)[i];
      } else {
        fail(fmt::format(".{}: expected numbers", what));
      }
      if (!std::isfinite(out[i])) fail(fmt::format(".{}: a value is not a number", what));
    }
    return out;
  }
  std::vector<double> numbers(const matvar_t* parent, const char* name, std::size_t index) const {
    return numbers(field(parent, name, index), name);
  }
  double number(const matvar_t* parent, const char* name, std::size_t index = 0) const {
    const auto all = numbers(parent, name, index);
    if (all.empty()) fail(fmt::format(".{}: empty", name));
    return all[0];
  }
  std::string text(const matvar_t* parent, const char* name, std::size_t index = 0) const {
    const matvar_t* v = field(parent, name, index);
    if (v->class_type != MAT_C_CHAR) fail(fmt::format(".{}: expected text", name));
    const auto* bytes = static_cast<const char*>(v->data);
    std::string out;
    const std::size_t step = v->nbytes / std::max<std::size_t>(1, count(v));
    for (std::size_t i = 0; i < count(v); ++i) out += bytes[i * std::max<std::size_t>(1, step)];
    return out;
  }

 private:
  struct CloseFile {
    void operator()(mat_t* f) const { Mat_Close(f); }
  };
  struct FreeVariable {
    void operator()(matvar_t* v) const { Mat_VarFree(v); }
  };
  std::string path_;
  // As long as the values of the file are read.
  ReadingScope scope_;
  MemoryLimit limit_{addressSpace() + kLargestModel};
  std::unique_ptr<mat_t, CloseFile> file_;
  std::unique_ptr<matvar_t, FreeVariable> model_;
};

/// Reads the grammar: start rules are components; the symbols of a component are its root and
/// parts.
class ModelReader {
 public:
  explicit ModelReader(const std::string& path)
      : in_(path), model_(in_.root()), blocks_(in_.find(model_, "blocks")) {}

  DpmModel read() const {
    DpmModel out;
    out.class_name = in_.text(model_, "class");
    out.cell = static_cast<int>(in_.number(model_, "sbin"));
    out.threshold = in_.number(model_, "thresh");
    if (out.cell < 4 || out.cell > 16) in_.fail(".sbin: expected 4 to 16");
    const matvar_t* rules = rulesOf(indexOf(in_.number(model_, "start")));
    for (std::size_t i = 0; i < MatModel::count(rules); ++i)
      out.components.push_back(component(rules, i));
    if (out.components.empty()) in_.fail(".rules: no component");
    return out;
  }

 private:
  std::size_t indexOf(double one_based) const {
    if (!(one_based >= 1 && one_based < 1e6)) in_.fail(": an index is out of range");
    return static_cast<std::size_t>(one_based) - 1;
  }
  const matvar_t* rulesOf(std::size_t symbol) const {
    const matvar_t* rules = in_.cell(in_.field(model_, "rules"), symbol);
    if (rules == nullptr || rules->class_type != MAT_C_STRUCT)
      in_.fail(".rules: not a star of parts");
    return rules;
  }
  /// The weights of a block (release 5), or of the field w (release 4).
  std::vector<double> weights(const matvar_t* parent, std::size_t index) const {
    if (blocks_ != nullptr && in_.find(parent, "blocklabel", index) != nullptr)
      return in_.numbers(blocks_, "w", indexOf(in_.number(parent, "blocklabel", index)));
    return in_.numbers(parent, "w", index);
  }
  /// Whether a block is stored mirrored (release 5).
  bool mirrored(const matvar_t* parent, std::size_t index) const {
    return blocks_ != nullptr && in_.find(parent, "flip", index) != nullptr &&
           in_.number(parent, "flip", index) != 0;
  }

  DpmFilter filter(std::size_t symbol) const {
    const matvar_t* symbols = in_.field(model_, "symbols");
    const matvar_t* filters = in_.field(model_, "filters");
    const std::size_t index = indexOf(in_.number(symbols, "filter", symbol));
    const auto size = in_.numbers(filters, "size", index);
    const auto values = weights(filters, index);
    if (size.size() < 2 || size[0] < 1 || size[1] < 1 || size[0] > 64 || size[1] > 64)
      in_.fail(".filters.size: expected rows and columns");
    DpmFilter f{static_cast<int>(size[0]), static_cast<int>(size[1]), {}};
    const auto height = static_cast<std::size_t>(f.height);
    const auto width = static_cast<std::size_t>(f.width);
    if (values.size() != height * width * kHogFeatures)
      in_.fail(fmt::format(".filters.w: {} weights for {} x {} cells of 32", values.size(), height,
                           width));
    f.weights.resize(values.size());
    const bool flip = mirrored(filters, index);
    for (std::size_t k = 0; k < kHogFeatures; ++k) {
      const std::size_t plane = flip ? static_cast<std::size_t>(kMirrored[k]) : k;
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t column = flip ? width - 1 - x : x;
        for (std::size_t y = 0; y < height; ++y)  // MATLAB: rows fastest
          f.weights[(y * width + x) * kHogFeatures + k] =
              static_cast<float>(values[(plane * width + column) * height + y]);
      }
    }
    return f;
  }

  DpmPart part(std::size_t symbol, const std::vector<double>& anchor) const {
    const matvar_t* rule = rulesOf(symbol);
    if (in_.text(rule, "type") != "D") in_.fail(".rules: a part without displacement");
    DpmPart out;
    out.filter = filter(indexOf(in_.number(rule, "rhs")));
    const matvar_t* def = in_.field(rule, "def");
    const auto costs = weights(def, 0);
    if (costs.size() != 4 || anchor.size() < 3) in_.fail(".rules.def: expected four costs");
    if (anchor[2] != 1) in_.fail(".rules.anchor: parts at twice the root's resolution only");
    std::copy(costs.begin(), costs.end(), out.deformation);
    if (mirrored(def, 0)) out.deformation[1] = -out.deformation[1];
    out.anchor_x = static_cast<int>(anchor[0]);
    out.anchor_y = static_cast<int>(anchor[1]);
    return out;
  }

  DpmComponent component(const matvar_t* rules, std::size_t index) const {
    DpmComponent out;
    const auto symbols = in_.numbers(rules, "rhs", index);
    const matvar_t* anchors = in_.field(rules, "anchor", index);
    const auto window = in_.numbers(rules, "detwindow", index);
    if (symbols.empty() || window.size() < 2) in_.fail(".rules: a component without root");
    out.height = static_cast<int>(window[0]);
    out.width = static_cast<int>(window[1]);
    const auto offset = weights(in_.field(rules, "offset", index), 0);
    out.offset = (offset.empty() ? 0 : offset[0]) * bias();
    if (const matvar_t* loc = in_.find(rules, "loc", index);
        loc != nullptr && loc->class_type == MAT_C_STRUCT && MatModel::count(loc) > 0) {
      const auto octaves = weights(loc, 0);
      if (octaves.size() != std::size(out.octaves))
        in_.fail(fmt::format(".rules.loc: {} weights, expected 3", octaves.size()));
      std::copy(octaves.begin(), octaves.end(), out.octaves);
    }
    out.root = filter(indexOf(symbols[0]));
    for (std::size_t p = 1; p < symbols.size(); ++p)
      out.parts.push_back(part(indexOf(symbols[p]), in_.numbers(in_.cell(anchors, p), "anchor")));
    return out;
  }
  /// Unit of the offsets in release 5.
  double bias() const {
    const matvar_t* features = in_.find(model_, "features");
    return blocks_ != nullptr && features != nullptr ? in_.number(features, "bias") : 1;
  }

  MatModel in_;
  const matvar_t* model_;
  const matvar_t* blocks_;
};

}  // namespace

DpmModel readDpmMatFile(const std::string& path) {
  DpmModel model = ModelReader(path).read();
  // KITTI's supervised models: component k has alpha = -pi + (k + 1) 2 pi / n (method.md 8.8; "_2_"
  // in the name).
  const std::string name = std::filesystem::path(path).filename().string();
  if (name.find("_2_") != std::string::npos) {
    const auto n = static_cast<double>(model.components.size());
    for (std::size_t k = 0; k < model.components.size(); ++k)
      model.components[k].heading = -kPi + (static_cast<double>(k) + 1) * kTwoPi / n;
    model.has_heading = true;
  }
  return model;
}

}  // namespace perception
