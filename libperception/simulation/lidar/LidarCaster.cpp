#include "libperception/simulation/lidar/LidarCaster.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

/// Embree's handles, released at the end.
struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

Scene newScene(RTCDevice device) {
  Scene scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);  // no beam slips through between triangles
  return scene;
}

Scene meshScene(RTCDevice device, const Mesh& mesh) {
  Scene scene = newScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(mesh.vertices[0]), mesh.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(mesh.triangles[0]), mesh.triangles.size());
  if (!vertices || !triangles) throw std::runtime_error("Embree: no memory for a mesh");
  std::copy(mesh.vertices.begin(), mesh.vertices.end(),
            static_cast<std::array<float, 3>*>(vertices));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(),
            static_cast<std::array<std::uint32_t, 3>*>(triangles));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

RTCRayHit makeRay(const Vector3& origin, const Vector3& direction, double range_max) {
  RTCRayHit r{};
  r.ray.org_x = static_cast<float>(origin.x()), r.ray.dir_x = static_cast<float>(direction.x());
  r.ray.org_y = static_cast<float>(origin.y()), r.ray.dir_y = static_cast<float>(direction.y());
  r.ray.org_z = static_cast<float>(origin.z()), r.ray.dir_z = static_cast<float>(direction.z());
  r.ray.tfar = static_cast<float>(range_max);
  r.ray.mask = ~0u;
  r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

/// `query`: rtcIntersect1 or rtcOccluded1; Embree 4 asks without a context.
template <class Query, class Ray>
void ask(Query query, RTCScene scene, Ray& ray) {
#if RTC_VERSION_MAJOR >= 4
  query(scene, &ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  query(scene, &context, &ray);
#endif
}

}  // namespace

struct LidarCaster::Impl {
  /// One part of an object, or the road, as it stands in the scene.
  struct Instance {
    Scene scene;  // of the mesh
    const Mesh* mesh = nullptr;
    int object = BeamHit::kRoad;
    std::size_t part = 0;
    RTCGeometry geometry = nullptr;  // owned by `top`; its id is the place in `instances`
    Pose3 T_world_part = Pose3::Identity();
    Pose3 T_part_world = Pose3::Identity();
  };

  Impl(const World& w, int threads)
      : world(w),
        device(rtcNewDevice(nullptr)),
        arena(threads > 0 ? threads : tbb::task_arena::automatic) {
    if (!device) throw std::runtime_error("Embree: no device");
    top = newScene(device.get());
    one_thread.execute([&] {
      add(w.road(), BeamHit::kRoad, 0);
      for (std::size_t i = 0; i < w.objects(); ++i) {
        const auto& parts = w.shape(i).parts;
        for (std::size_t k = 0; k < parts.size(); ++k) add(parts[k].mesh, static_cast<int>(i), k);
      }
    });
  }

  void add(const Mesh& mesh, int object, std::size_t part) {
    Instance instance;
    instance.scene = meshScene(device.get(), mesh);
    instance.mesh = &mesh;
    instance.object = object;
    instance.part = part;
    instance.geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance.geometry, instance.scene.get());
    rtcAttachGeometryByID(top.get(), instance.geometry, static_cast<unsigned>(instances.size()));
    rtcReleaseGeometry(instance.geometry);
    instances.push_back(std::move(instance));
  }

  void place(Instance& instance, const Pose3& pose) const {
    instance.T_world_part = pose;
    instance.T_part_world = pose.inverse();
    const Eigen::Matrix<float, 3, 4> m = pose.matrix().topRows<3>().cast<float>();  // column-major
    rtcSetGeometryTransform(instance.geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m.data());
    rtcCommitGeometry(instance.geometry);
  }

  BeamHit hit(const Vector3& origin, const Vector3& direction, double range_max) const {
    RTCRayHit r = makeRay(origin, direction, range_max);
    ask(&rtcIntersect1, top.get(), r);
    return hitOf(r, direction);
  }

  SurfaceHit surface(const Vector3& origin, const Vector3& direction, double range_max) const {
    RTCRayHit r = makeRay(origin, direction, range_max);
    ask(&rtcIntersect1, top.get(), r);
    SurfaceHit result;
    static_cast<BeamHit&>(result) = hitOf(r, direction);
    if (result.object == BeamHit::kNothing) return result;
    const Instance& instance = instances[r.hit.instID[0]];
    const Vector3 normal =
        instance.T_world_part.linear() * Vector3(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z).normalized();
    result.normal = normal.dot(direction) > 0 ? Vector3(-normal) : normal;
    return result;
  }

  bool blocked(const Vector3& origin, const Vector3& direction, double range_max) const {
    RTCRay ray = makeRay(origin, direction, range_max).ray;
    ask(&rtcOccluded1, top.get(), ray);
    return ray.tfar < 0;
  }

  BeamHit hitOf(const RTCRayHit& r, const Vector3& direction) const {
    BeamHit result;
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
    const Instance& instance = instances[r.hit.instID[0]];
    const Vector3 normal(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z);  // of the part's frame, any length
    const Vector3 seen = instance.T_world_part.linear().transpose() * direction;
    const double length = normal.norm();
    result.range = r.ray.tfar;
    result.cos_incidence = length > 0 ? static_cast<float>(std::abs(normal.dot(seen)) / length) : 0;
    result.object = instance.object;
    result.material = instance.mesh->materials[r.hit.primID];
    return result;
  }

  // Whether the beam would meet the object if it were alone.
  bool meets(const Vector3& origin, const Vector3& direction, int object) const {
    for (const Instance& instance : instances) {
      if (instance.object != object) continue;
      RTCRayHit r =
          makeRay(instance.T_part_world * origin, instance.T_part_world.linear() * direction,
                  std::numeric_limits<double>::infinity());
      ask(&rtcIntersect1, instance.scene.get(), r);
      if (r.hit.geomID != RTC_INVALID_GEOMETRY_ID) return true;
    }
    return false;
  }

  const World& world;
  Device device;
  Scene top;
  std::optional<double> time;  // [s] at which the scene stands
  std::vector<Instance> instances;
  mutable tbb::task_arena arena;
  tbb::task_arena one_thread{1};  // trees built by one thread are the same every time
};

LidarCaster::LidarCaster(const World& world, int threads)
    : impl_(std::make_unique<Impl>(world, threads)) {
  setTime(0);
}

LidarCaster::~LidarCaster() = default;

const World& LidarCaster::world() const { return impl_->world; }

void LidarCaster::setTime(double t) {
  if (impl_->time == t) return;
  impl_->time = t;
  std::vector<Pose3> poses;
  for (Impl::Instance& instance : impl_->instances) {
    if (instance.object == BeamHit::kRoad) {
      impl_->place(instance, Pose3::Identity());
      continue;
    }
    if (instance.part == 0) poses = world().parts(static_cast<std::size_t>(instance.object), t);
    impl_->place(instance, poses[instance.part]);
  }
  impl_->one_thread.execute([&] { rtcCommitScene(impl_->top.get()); });
  if (rtcGetDeviceError(impl_->device.get()) != RTC_ERROR_NONE) {
    throw std::runtime_error(fmt::format("Embree: the scene at t = {} s cannot be built", t));
  }
}

std::vector<BeamHit> LidarCaster::cast(const Vector3& origin,
                                       const std::vector<Vector3>& directions,
                                       double range_max) const {
  std::vector<BeamHit> hits(directions.size());
  constexpr std::size_t kGrain = 1024;  // beams a task
  if (directions.size() <= kGrain) {    // no task for a few beams
    for (std::size_t i = 0; i < hits.size(); ++i) {
      hits[i] = impl_->hit(origin, directions[i], range_max);
    }
    return hits;
  }
  parallel(directions.size(), kGrain, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) hits[i] = impl_->hit(origin, directions[i], range_max);
  });
  return hits;
}

SurfaceHit LidarCaster::surface(const Vector3& origin, const Vector3& direction,
                                double range_max) const {
  return impl_->surface(origin, direction, range_max);
}

bool LidarCaster::blocked(const Vector3& origin, const Vector3& direction, double range_max) const {
  return impl_->blocked(origin, direction, range_max);
}

void LidarCaster::parallel(std::size_t count, std::size_t grain,
                           const std::function<void(std::size_t, std::size_t)>& work) const {
  impl_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
  });
}

// A grid of beams over the directions in which the object's box lies.
double LidarCaster::visibleShare(const Vector3& eye, std::size_t object) const {
  constexpr int kColumns = 16, kRows = 16;
  const int index = static_cast<int>(object);
  // Frame with x towards the middle of the object, so that directions to it are far from any wrap.
  std::vector<Vector3> corners;
  Vector3 middle = Vector3::Zero();
  for (const Impl::Instance& instance : impl_->instances) {
    if (instance.object != index) continue;
    for (const auto& v : instance.mesh->vertices) {
      corners.push_back(instance.T_world_part * Vector3(v[0], v[1], v[2]));
      middle += corners.back();
    }
  }
  if (corners.empty()) return 0;
  middle /= static_cast<double>(corners.size());
  const Vector3 ahead = (middle - eye).normalized();
  const Vector3 left = Vector3::UnitZ().cross(ahead).normalized(), up = ahead.cross(left);
  constexpr double kNear = 0.05;  // [m] corners beside or behind the eye: it stands in the object
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& corner : corners) {
    const Vector3 d = corner - eye;
    const Vector2 slope = Vector2(left.dot(d), up.dot(d)) / std::max(kNear, ahead.dot(d));
    low = low.cwiseMin(slope), high = high.cwiseMax(slope);
  }
  int alone = 0, seen = 0;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kRows; ++j) {
      const double a = low.x() + (high.x() - low.x()) * (i + .5) / kColumns;
      const double b = low.y() + (high.y() - low.y()) * (j + .5) / kRows;
      const Vector3 direction = (ahead + a * left + b * up).normalized();
      if (!impl_->meets(eye, direction, index)) continue;
      ++alone;
      const double far = std::numeric_limits<double>::infinity();
      seen += impl_->hit(eye, direction, far).object == index ? 1 : 0;
    }
  }
  return alone > 0 ? static_cast<double>(seen) / alone : 0;
}

}  // namespace perception
