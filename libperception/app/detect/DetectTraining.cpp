#include <fmt/format.h>

#include <filesystem>

#include "libperception/app/detect/DetectApp.h"
#include "libperception/detectors/HeadingHead.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr int kImagesAFold = 3;  // neighboring images of a drive show the same objects

}  // namespace

void DetectApp::trainHeading() const {
  if (labels.empty() || inputs.empty())
    throw Error(ExitCode::kUsage, "--train-heading needs -i IMAGES and --labels");
  const ImageLabels truth(labels, LabelRules{min_height, max_truncation, max_occlusion});
  std::vector<HeadingExample> examples;
  int fold = 0;
  for (const std::string& file : imageFiles(inputs)) {
    stopIfAsked();
    const auto image = readImage(file);
    if (!image) throw DataError(fmt::format("{}: not an image", file));
    ++fold;
    for (const LabeledBox& l : truth.of(fs::path(file).filename().string())) {
      if (l.label != heading_label || l.ignore || l.area || !l.heading) continue;
      for (const bool mirrored : {false, true}) {
        HeadingExample e;
        e.features = HeadingHead::describe(*image, l.box, false, mirrored);
        e.heading = mirrored ? wrapAngle(kPi - *l.heading) : *l.heading;
        e.fold = fold / kImagesAFold;
        if (!e.features.empty()) examples.push_back(std::move(e));
      }
    }
  }
  const HeadingHead head = HeadingHead::train(heading_label, examples);
  writeFile(train_heading, head.text());
  fmt::print(
      "{}: {} pictures of {} images, mirrored ones included\n"
      "axis within {:.1f} deg (rms), front and back confused in {:.1f} % (cross-validated)\n"
      "[sensor.LABEL.detector] heading_model = {} takes both\n",
      train_heading, head.examples(), fold, degrees(head.axisSigma()), 100 * head.flipShare(),
      train_heading);
}

}  // namespace perception
