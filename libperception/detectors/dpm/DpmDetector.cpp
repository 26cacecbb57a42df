#include <algorithm>

#include "libperception/detectors/Detector.h"
#include "libperception/detectors/dpm/DpmBank.h"
#include "libperception/detectors/dpm/DpmEngine.h"

namespace perception {
namespace {

ObjectDetection::ImageBox inside(ObjectDetection::ImageBox b, const Raster& image) {
  b.x1 = std::max(b.x1, 0.0);
  b.y1 = std::max(b.y1, 0.0);
  b.x2 = std::min(b.x2, image.width - 1.0);
  b.y2 = std::min(b.y2, image.height - 1.0);
  return b;
}

/// Detector with DpmEngine for banks of deformable part models.
class DpmDetector final : public Detector {
 public:
  explicit DpmDetector(const DetectorSetup& setup) : engine_(targetsOf(setup), setup.dpm.options) {}

  std::vector<ObjectDetection> detect(const Raster& image,
                                      const SearchRegion& region) const override {
    std::vector<ObjectDetection> out;
    for (const DpmDetection& d : engine_.detect(image, region)) {
      ObjectDetection o;
      o.label = engine_.targets()[static_cast<std::size_t>(d.target)].model.class_name;
      o.score = d.score;
      o.image_box = inside(d.box, image);
      o.heading = d.heading;
      if (o.image_box->x2 > o.image_box->x1 && o.image_box->y2 > o.image_box->y1)
        out.push_back(std::move(o));
    }
    return out;
  }
  bool parallel() const override { return true; }

 private:
  static std::vector<DpmTarget> targetsOf(const DetectorSetup& setup) {
    std::vector<DpmTarget> targets;
    for (const auto& [name, params] : setup.models) {
      DpmTarget t;
      t.model = readDpmModel(setup.pathOf(params));
      if (!params.label.empty()) t.model.class_name = params.label;
      t.threshold = params.threshold > -1e8 ? params.threshold : t.model.threshold;
      t.low = params.low;
      t.high = params.high;
      targets.push_back(std::move(t));
    }
    return targets;
  }
  DpmEngine engine_;
};

}  // namespace

std::unique_ptr<Detector> makeDpmDetector(const DetectorSetup& setup) {
  return std::make_unique<DpmDetector>(setup);
}

}  // namespace perception
