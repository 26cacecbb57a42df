#include "libperception/simulation/cameras/ImageCamera.h"

#include <algorithm>
#include <cmath>

#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/Appearance.h"
#include "libperception/simulation/world/GroundAppearance.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr double kFar = 1500;  // [m] largest range of rays: sky or haze beyond
constexpr double kLift =
    0.03;  // [m] offset of secondary rays from the surface, against self-shadowing by bumps
constexpr double kCover = 1.5;     // [m] objects lower than this above the ground occlude the sky
constexpr double kCovered = 0.35;  // share of skylight left below them
constexpr double kEdge = 0.03;     // step of display values from which a pixel takes more rays
constexpr double kSeenThrough = 0.3;  // transmittance of leaves

/// Result of one ray.
struct Sample {
  Rgb value = Rgb::Zero();  ///< linear display value
  float range = CameraView::kSky;
  int object = BeamHit::kNothing;
};

/// Light along rays from one eye at one time.
class Renderer {
 public:
  Renderer(const LidarCaster& caster, double t, const CameraModel& camera, const Lighting& light,
           const Pose3& T_world_camera)
      : caster_(caster),
        scenario_(caster.world().scenario()),
        camera_(camera),
        light_(light),
        eye_(T_world_camera.translation()),
        axes_(T_world_camera.linear()),
        sun_(light.sunDirection()),
        ground_(scenario_) {
    for (std::size_t i = 0; i < caster.world().objects(); ++i) {
      T_object_world_.push_back(caster.world().object(i, t).T_world_object.inverse());
    }
  }

  Sample at(double u, double v) const {
    const Vector3 direction = axes_ * opticalRay(camera_, u, v);
    SurfaceHit hit = caster_.surface(eye_, direction, kFar);
    // The road's mesh ends somewhere; the ground does not.
    const bool below = hit.object == BeamHit::kNothing && direction.z() * kFar < -eye_.z();
    if (below) hit.range = static_cast<float>(-eye_.z() / direction.z());
    Sample sample;
    sample.object = hit.object;
    if (hit.object == BeamHit::kNothing && !below) {
      sample.value = light_.exposed(light_.hazySky(direction));
      return sample;
    }
    sample.range = hit.range;
    const Vector3 place = eye_ + static_cast<double>(hit.range) * direction;
    const Rgb radiance = hit.object >= 0 ? onObject(hit, place, direction)
                                         : onGround(place, static_cast<double>(hit.range));
    sample.value = light_.exposed(light_.through(radiance, hit.range, direction));
    return sample;
  }

 private:
  // Light of the sun on a surface, over pi; none in a shadow.
  Rgb sunOn(const Vector3& place, const Vector3& normal, double floor) const {
    const double cosine = std::max(normal.dot(sun_), floor);
    if (!light_.hasSun() || cosine <= 0) return Rgb::Zero();
    if (caster_.blocked(place + kLift * normal, sun_, kFar)) return Rgb::Zero();
    return cosine * light_.sunlight();
  }

  // Of the own headlights, which are taken to be where the camera is: no shadows are seen.
  Rgb lampsOn(const Vector3& place, const Vector3& normal, double range) const {
    if (light_.headlights <= 0) return Rgb::Zero();
    const Vector3 direction = (place - eye_).normalized();
    const double cosine = std::max(0.0, -normal.dot(direction));
    return Rgb::Constant(cosine * light_.headlightsOn(direction, range));
  }

  Rgb onGround(const Vector3& place, double range) const {
    const double pixel = range / camera_.fx;
    const Vector3 up = Vector3::UnitZ();  // bumps of a centimeter are not rendered
    const bool covered = caster_.blocked(place + kLift * up, up, kCover);
    const Rgb arriving = sunOn(place, up, 0) + (covered ? kCovered : 1) * light_.ambientOn(up) +
                         lampsOn(place, up, range);
    return ground_.reflectance(place.head<2>(), pixel).cwiseProduct(arriving);
  }

  Rgb onObject(const SurfaceHit& hit, const Vector3& place, const Vector3& direction) const {
    const auto index = static_cast<std::size_t>(hit.object);
    const Pose3& T = T_object_world_[index];
    const Finish finish = finishOf(scenario_.objects[index], hit.material, T * place,
                                   T.linear() * hit.normal, hit.range / camera_.fx);
    // Leaves transmit light, independent of their orientation.
    const double floor = hit.material == Material::kLeaf ? kSeenThrough : 0;
    const Rgb arriving = sunOn(place, hit.normal, floor) + light_.ambientOn(hit.normal) +
                         lampsOn(place, hit.normal, hit.range);
    const Rgb dull = finish.reflectance.cwiseProduct(arriving);
    if (finish.mirror <= 0) return dull;
    // Schlick's approximation of Fresnel's share.
    const double flat = std::pow(1 + std::min(0.0, direction.dot(hit.normal)), 5);
    const double share = finish.mirror + (1 - finish.mirror) * flat;
    const Vector3 mirrored = direction - 2 * direction.dot(hit.normal) * hit.normal;
    const Rgb seen = mirrored.z() > 0 ? light_.sky(mirrored) : Rgb(.12 * light_.sky(mirrored));
    return (1 - share) * dull + share * seen;
  }

  const LidarCaster& caster_;
  const Scenario& scenario_;
  CameraModel camera_;
  Lighting light_;
  Vector3 eye_;
  Eigen::Matrix3d axes_;
  Vector3 sun_;
  GroundAppearance ground_;
  std::vector<Pose3> T_object_world_;
};

bool differs(const Sample& a, const Sample& b) {
  return a.object != b.object || (a.value - b.value).cwiseAbs().maxCoeff() > kEdge;
}

}  // namespace

void ImageCameraParams::visit(ParamVisitor& v) {
  v.integer("width", width, {16, 20000}, "of the image, pixels; a panorama's is even");
  v.integer("height", height, {16, 20000}, "of a pinhole's image, pixels");
  v.angle("fov_deg", fov, {5, 360}, "horizontal; 360: a panorama, half as high as wide");
  v.require(panorama() || fov <= radians(150), "fov_deg: expected at most 150, or 360");
  v.require(!panorama() || width % 2 == 0, "width: expected an even number for a panorama");
}

CameraModel ImageCameraParams::model() const {
  CameraModel m;
  m.width = width, m.height = panorama() ? width / 2 : height;
  m.cx = .5 * m.width - .5, m.cy = .5 * m.height - .5;
  if (panorama()) {
    m.projection = CameraModel::Projection::kEquirectangular;
    m.fx = m.fy = width / kTwoPi;
  } else {
    m.fx = m.fy = .5 * width / std::tan(.5 * fov);
  }
  return m;
}

RenderedImage renderImage(const LidarCaster& caster, double t, const CameraModel& camera,
                          const Lighting& light, const Pose3& T_world_camera, CameraView* view) {
  const Renderer renderer(caster, t, camera, light, T_world_camera);
  const auto width = static_cast<std::size_t>(camera.width),
             height = static_cast<std::size_t>(camera.height);
  std::vector<Sample> samples(width * height);
  caster.parallel(height, 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first * width; i < last * width; ++i) {
      samples[i] = renderer.at(static_cast<double>(i % width), static_cast<double>(i / width));
    }
  });
  RenderedImage image;
  image.raster = {camera.width, camera.height, 3, std::vector<std::uint8_t>(3 * width * height)};
  image.objects.resize(width * height);
  if (view) {
    view->camera = camera, view->T_world_camera = T_world_camera, view->light = light;
    view->linear.resize(width * height), view->range.resize(width * height);
  }
  const auto finish = [&](std::size_t i) {
    const std::size_t x = i % width, y = i / width;
    const bool edge = (x > 0 && differs(samples[i], samples[i - 1])) ||
                      (x + 1 < width && differs(samples[i], samples[i + 1])) ||
                      (y > 0 && differs(samples[i], samples[i - width])) ||
                      (y + 1 < height && differs(samples[i], samples[i + width]));
    Rgb value = samples[i].value;
    if (edge) {
      value.setZero();
      for (const double du : {-.25, .25}) {
        for (const double dv : {-.25, .25}) {
          value +=
              .25 * renderer.at(static_cast<double>(x) + du, static_cast<double>(y) + dv).value;
        }
      }
    }
    for (int c = 0; c < 3; ++c) {  // blue, green, red
      image.raster.pixels[3 * i + static_cast<std::size_t>(c)] = displayByte(value(2 - c));
    }
    image.objects[i] = samples[i].object;
    if (view) view->linear[i] = value.cast<float>(), view->range[i] = samples[i].range;
  };
  caster.parallel(height, 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first * width; i < last * width; ++i) finish(i);
  });
  return image;
}

}  // namespace perception
