#include "gui-offscreen/html/RunData.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "gui-offscreen/drawing/Palette.h"
#include "gui-offscreen/drawing/Picture.h"
#include "gui-offscreen/html/HtmlText.h"

namespace perception {
namespace {

using Json = nlohmann::json;

constexpr double kFarthestPoint = 320;  // [m] that 16 bits of centimeters reach
constexpr double kHeightStep = 0.02;    // [m] of a return's height
constexpr float kGround = 0.15F;        // [m] height of returns of the ground
constexpr int kImageWidth = 720;        // [px]
constexpr int kImageQuality = 72;       // of JPEG
// Level 9 takes five times as long as 6 and makes the page of the demo 0.7 % smaller.
constexpr int kGzipLevel = 6;

Json rounded(double value, double step = 0.01) {
  if (!std::isfinite(value)) return nullptr;
  const double steps = std::round(value / step);
  return steps == 0 ? Json(0) : Json(steps / std::round(1 / step));
}

void put16(std::string& to, double meters) {
  const auto cm = static_cast<std::int16_t>(std::lround(meters * 100));
  to += static_cast<char>(cm & 255);
  to += static_cast<char>((cm >> 8) & 255);
}

char byteOf(double value) {
  return static_cast<char>(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
}

/// `most` of `count` indices, evenly spread.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(all[i * all.size() / most]);
  return kept;
}

/// The same of returns; where they do not all fit, those of the ground get a quarter of the room.
std::vector<std::size_t> mostlyRaised(const std::vector<ViewPoint>& points,
                                      const std::vector<std::size_t>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<std::size_t> raised, ground;
  for (const std::size_t i : all) (points[i].height < kGround ? ground : raised).push_back(i);
  raised = thinned(raised, most - std::min(ground.size(), most / 4));
  ground = thinned(ground, most - raised.size());
  raised.insert(raised.end(), ground.begin(), ground.end());
  return raised;
}

/// Columns of 16 bits by coordinate, then two of a byte.
template <class Place, class Byte>
void putBlock(std::string& to, const std::vector<std::size_t>& kept, Place place, Byte first,
              Byte second) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::size_t i : kept) put16(to, place(i)[axis]);
  }
  for (const std::size_t i : kept) to += byteOf(first(i));
  for (const std::size_t i : kept) to += byteOf(second(i));
}

Json matrixOf(const Pose3& T, const Vector3& origin) {
  Json m = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m.push_back(rounded(T.linear()(r, c), 1e-5));
    m.push_back(rounded(T.translation()[r] - origin[r], 1e-3));
  }
  return m;
}

}  // namespace

std::string gzipped(const std::string& bytes) {
  z_stream z{};
  constexpr int kGzip = 15 + 16;
  if (deflateInit2(&z, kGzipLevel, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib: no memory");
  std::string out(deflateBound(&z, static_cast<uLong>(bytes.size())), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int code = deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  if (code != Z_STREAM_END) throw std::runtime_error("zlib: not compressed");
  return out;
}

RunData::RunData(const TrackedRun& run, const RunRecord& record, const Budget& budget,
                 const std::optional<Vector3>& origin)
    : run_(run), budget_(budget) {
  const double scenes = static_cast<double>(std::max<std::size_t>(run.scenes.size(), 1));
  const double each = static_cast<double>(budget.points) / kBase64 / kPointBytes / scenes;
  points_per_scene_ = static_cast<std::size_t>(each * (1 - kCellShare));
  cells_per_scene_ = static_cast<std::size_t>(each * kCellShare);
  const double images = static_cast<double>(std::max<std::size_t>(budget.images / kImageBytes, 1));
  images_every_ = budget.every_image > 0 ? budget.every_image
                                         : static_cast<std::size_t>(std::ceil(scenes / images));
  if (!run.scenes.empty()) origin_ = run.scenes.front().ego.T_world_ego.translation();
  if (origin) origin_ = *origin;
  json_ = {{"id", record.hash},       {"log", record.input},      {"simulated", record.simulated},
           {"config", record.config}, {"classes", Json::array()}, {"scenes", Json::array()},
           {"objects", Json::array()}};
  for (std::size_t c = 0; c < run.class_names.size(); ++c) {
    const std::string& name = run.class_names[c];
    json_["classes"].push_back({{"name", name},
                                {"color", hexOf(colorOfClass(name, static_cast<int>(c)))},
                                {"muted", isMuted(name)}});
  }
  for (const Scene& scene : run.scenes) {
    const Pose3& T = scene.ego.T_world_ego;
    Json s = {{"t", rounded(scene.stamp - run.first_stamp, 1e-3)},
              {"ego", placed(T.translation())},
              {"speed", rounded(scene.ego.velocity.norm())}};
    s["ego"].push_back(rounded(std::atan2(T.linear()(1, 0), T.linear()(0, 0)), 1e-4));
    if (scene.path) {
      s["path"] = {rounded(scene.path->distance), rounded(scene.path->seen), scene.path->blocked,
                   scene.path->stop, scene.path->owner};
    }
    json_["scenes"].push_back(std::move(s));
  }
  addTracks();
}

Json RunData::placed(const Vector3& p) const {
  return {rounded(p.x() - origin_.x()), rounded(p.y() - origin_.y()), rounded(p.z() - origin_.z())};
}

void RunData::addTracks() {
  std::map<std::uint64_t, Json> objects;
  for (std::size_t k = 0; k < run_.scenes.size(); ++k) {
    for (const SceneObject& o : run_.scenes[k].objects) {
      Json& object = objects[o.id];
      object["id"] = o.id;
      object["k"].push_back(k);
      Json pose = placed(o.position);
      for (const double v : {o.length, o.width, o.height, o.velocity.x(), o.velocity.y()})
        pose.push_back(rounded(v));
      pose.push_back(rounded(o.yaw, 1e-3));
      pose.push_back(rounded(o.existence, 1e-3));
      pose.push_back(rounded(std::max(o.sd_x, o.sd_y)));
      object["row"].push_back(std::move(pose));
      object["c"].push_back(o.class_id);
      object["sure"].push_back(o.classified ? 1 : 0);
      Json p = Json::array();
      for (const double v : o.class_probability) p.push_back(rounded(v, 1e-3));
      object["p"].push_back(std::move(p));
      for (const auto& [modality, stamp] : o.last_hit) {
        Json& hits = object["hits"][std::string(1, letterOf(modality))];
        const Json t = rounded(stamp - run_.first_stamp, 1e-3);
        if (hits.empty() || hits.back() != t) hits.push_back(t);
      }
    }
  }
  for (auto& [id, object] : objects) json_["objects"].push_back(std::move(object));
}

void RunData::add(std::size_t index, const SceneView& view) {
  Json& scene = json_["scenes"].at(index);
  addPoints(view, run_.scenes[index].ego.T_world_ego.translation(), scene);
  for (const ViewRadarReturn& r : view.radar) {
    Json row = placed(r.place);
    for (int i = 0; i < 2; ++i) row.push_back(r.has_rate ? rounded(r.radial_velocity[i]) : Json(0));
    scene["radar"].push_back(std::move(row));
  }
  for (const ViewMeasurement& m : view.measurements) {
    Json row = {std::string(1, letterOf(m.modality)), placed(m.place), Json::array()};
    for (const Vector3& corner : m.outline) row[2].push_back(placed(corner));
    scene["measurements"].push_back(std::move(row));
  }
  addTruth(index, view);
  if (view.corridor) {
    // Along the vehicle's own x axis: behind it distances are negative and a left turn is a right
    // one.
    const double sign = view.corridor->backward ? -1 : 1;
    scene["corridor"] = {rounded(sign * view.corridor->curvature, 1e-5),
                         rounded(view.corridor->width), rounded(sign * view.corridor->from),
                         rounded(sign * view.free.known()), view.free.blocked};
  }
  if (view.image && index % images_every_ == 0) addImage(*view.image, scene);
}

void RunData::addTruth(std::size_t index, const SceneView& view) {
  Json& scene = json_["scenes"].at(index);
  for (const TruthObject& o : view.truth) {
    Json row = placed(o.position);
    for (const double v : {o.length, o.width, o.height}) row.push_back(rounded(v));
    row.push_back(rounded(o.yaw, 1e-3));
    row.push_back(o.type);
    row.push_back(o.id);
    scene["truth"].push_back(std::move(row));
  }
}

void RunData::setErrors(const RunErrors& errors) {
  const auto orNull = [](const std::optional<double>& v, double step) {
    return v ? rounded(*v, step) : Json(nullptr);
  };
  for (Json& object : json_["objects"]) {
    for (const Json& k : object.at("k")) {
      const auto& of_scene = errors.at(k.get<std::size_t>());
      const auto found = of_scene.find(object.at("id").get<std::uint64_t>());
      if (found == of_scene.end()) {
        object["err"].push_back(nullptr);
        continue;
      }
      const TruthErrors& e = found->second;
      object["err"].push_back({e.truth, rounded(e.position), orNull(e.speed, 0.01),
                               orNull(e.heading, 1e-3), e.right_class ? 1 : 0});
    }
  }
}

void RunData::addPoints(const SceneView& view, const Vector3& center, Json& scene) {
  const auto near = [&](const Vector3& p) {
    return (p - center).allFinite() && (p - center).cwiseAbs().maxCoeff() < kFarthestPoint;
  };
  std::vector<std::size_t> all, cells;
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    if (near(view.points[i].place)) all.push_back(i);
  }
  for (std::size_t i = 0; i < view.occupied.size(); ++i) {
    if (near(view.occupied[i].center)) cells.push_back(i);
  }
  const auto kept = mostlyRaised(view.points, all, points_per_scene_);
  points_seen_ += all.size();
  points_kept_ += kept.size();
  cells = thinned(cells, cells_per_scene_);
  scene["block"] = {points_.size(), kept.size(), cells.size()};
  using Byte = std::function<double(std::size_t)>;
  putBlock(
      points_, kept, [&](std::size_t i) -> Vector3 { return view.points[i].place - center; },
      Byte([&](std::size_t i) { return view.points[i].height / kHeightStep; }),
      Byte([&](std::size_t i) { return view.points[i].trust * 255; }));
  putBlock(
      points_, cells, [&](std::size_t i) -> Vector3 { return view.occupied[i].center - center; },
      Byte([&](std::size_t i) { return view.occupied[i].size.x() * 100; }),
      Byte([&](std::size_t i) { return view.occupied[i].size.z() / kHeightStep; }));
}

void RunData::addImage(const ViewImage& image, Json& scene) {
  const CameraModel& camera = image.camera;
  Json shown = {{"sensor", image.sensor},
                {"size", {camera.width, camera.height}},
                {"k", {camera.fx, camera.fy, camera.cx, camera.cy}},
                {"panorama", camera.projection == CameraModel::Projection::kEquirectangular},
                {"T", matrixOf(image.T_world_camera, origin_)},
                {"boxes", Json::array()}};
  for (const ViewImage::Box& b : image.boxes) {
    shown["boxes"].push_back({rounded(b.box.x1, 0.1), rounded(b.box.y1, 0.1),
                              rounded(b.box.x2, 0.1), rounded(b.box.y2, 0.1), b.label});
  }
  if (image.picture.width > 0 && images_bytes_ < budget_.images) {
    shown["jpeg"] = images_.size();
    images_.push_back(base64(jpegOf(image.picture, kImageWidth, kImageQuality)));
    images_bytes_ += images_.back().get_ref<const std::string&>().size();
  }
  scene["image"] = std::move(shown);
}

}  // namespace perception
