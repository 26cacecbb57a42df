#include <fmt/format.h>

#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/detection/DetectRun.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {
namespace {

constexpr int kImagesAFold = 3;  // neighboring images of a drive show the same objects

}  // namespace

std::pair<HeadingHead, int> headingsLearned(const std::vector<std::string>& images,
                                            const ImageLabels& truth, const std::string& label) {
  std::vector<HeadingExample> examples;
  int fold = 0;
  for (const std::string& file : images) {
    stopIfAsked();
    const auto image = readImage(file);
    if (!image) throw DataError(fmt::format("{}: not an image", file));
    ++fold;
    for (const LabeledBox& l : truth.of(std::filesystem::path(file).filename().string())) {
      if (l.label != label || l.ignore || l.area || !l.heading) continue;
      for (const bool mirrored : {false, true}) {
        HeadingExample e;
        e.features = HeadingHead::describe(*image, l.box, false, mirrored);
        e.heading = mirrored ? wrapAngle(kPi - *l.heading) : *l.heading;
        e.fold = fold / kImagesAFold;
        if (!e.features.empty()) examples.push_back(std::move(e));
      }
    }
  }
  return {HeadingHead::train(label, examples), fold};
}

}  // namespace perception
