#include "libperception/calibration/clusters/ClusterSamples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace perception {
namespace {

/// An object's box grown by a margin [m], world.
class GrownBox {
 public:
  GrownBox(const TruthObject& o, double margin)
      : place_(o.position),
        cos_(std::cos(o.yaw)),
        sin_(std::sin(o.yaw)),
        half_length_(o.length / 2 + margin),
        half_width_(o.width / 2 + margin),
        height_(o.height + margin),
        margin_(margin),
        reach_(half_length_ + half_width_) {}

  bool holds(const Vector3& p) const {
    const double x = p.x() - place_.x(), y = p.y() - place_.y(), up = p.z() - place_.z();
    if (std::abs(x) > reach_ || std::abs(y) > reach_) return false;  // most
    return std::abs(x * cos_ + y * sin_) < half_length_ &&
           std::abs(y * cos_ - x * sin_) < half_width_ && up > -margin_ && up < height_;
  }

 private:
  Vector3 place_;
  double cos_, sin_, half_length_, half_width_, height_, margin_, reach_;
};

bool hasBox(const TruthObject& o) {
  return o.position.allFinite() && std::isfinite(o.yaw) && o.length > 0 && o.width > 0 &&
         o.height > 0;
}

/// SemanticKITTI's numbers of classes with a kind; moving ones are 252 and up.
std::optional<ClusterKind> kindOfLabel(std::uint16_t label) {
  switch (label) {
    case 30:
    case 254:
      return ClusterKind::kPedestrian;
    case 31:
    case 253:
      return ClusterKind::kCyclist;
    case 10:
    case 13:
    case 16:
    case 18:
    case 20:
    case 252:
    case 256:
    case 257:
    case 258:
    case 259:
      return ClusterKind::kVehicle;
    case 11:
    case 15:
    case 32:
    case 255:
      return ClusterKind::kMixed;  // two-wheelers alone, motorcyclists: neither a kind nor a thing
    default:
      return isPhantomLabel(label) ? std::optional(ClusterKind::kPhantom) : std::nullopt;
  }
}

/// Obstacle returns, world [m].
std::vector<Vector3> placesInWorld(const SensorFrame& frame, const LidarDetections& found) {
  std::vector<Vector3> places;
  places.reserve(found.obstacles.size());
  for (const std::uint32_t k : found.obstacles)
    places.push_back(frame.ego.T_world_ego * Vector3(static_cast<double>(found.points.x[k]),
                                                     static_cast<double>(found.points.y[k]),
                                                     static_cast<double>(found.points.z[k])));
  return places;
}

}  // namespace

std::optional<ClusterKind> kindOfTruth(const std::string& type) {
  static const std::array<std::pair<const char*, ClusterKind>, 8> kKinds = {
      {{"Car", ClusterKind::kVehicle},
       {"Van", ClusterKind::kVehicle},
       {"Truck", ClusterKind::kVehicle},
       {"Bus", ClusterKind::kVehicle},
       {"Tram", ClusterKind::kVehicle},
       {"Pedestrian", ClusterKind::kPedestrian},
       {"Person_sitting", ClusterKind::kPedestrian},
       {"Cyclist", ClusterKind::kCyclist}}};
  for (const auto& [name, kind] : kKinds)
    if (type == name) return kind;
  return std::nullopt;
}

ClusterSampler::ClusterSampler(std::string sensor, const LidarFrontEnd& front_end,
                               const GroundTruth& truth, const PointLabels& labels, std::size_t log,
                               const SampleRules& rules, ClusterSamples& samples)
    : sensor_(std::move(sensor)),
      front_end_(front_end),
      truth_(truth),
      labels_(labels),
      log_(log),
      rules_(rules),
      samples_(samples) {}

void ClusterSampler::onFrame(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (frame.sensor != sensor_ || !cloud) return;
  if (!first_) first_ = frame.stamp;
  const auto labels = labels_.ofFrame(frame.frame, cloud->size());
  const auto instant =
      std::find_if(truth_.instants.begin(), truth_.instants.end(),
                   [&](const GroundTruth::Instant& i) { return i.frame == frame.frame; });
  if (!labels && instant == truth_.instants.end()) return;
  LidarDetections found = front_end_.detect(frame);
  const DirectionCells cells(found.points);
  found.field = fieldOf(cells, found.height, front_end_.params().obstacles.height_min);
  const std::size_t first = samples_.clusters.size();
  points_.clear();
  for (DescribedCluster& cluster : describedClusters(found, *cloud, cells)) {
    Segment& segment = cluster.segment;
    ClusterSample sample;
    sample.log = log_, sample.frame = frame.frame, sample.t = frame.stamp - *first_;
    sample.descriptor = cluster.descriptor;
    sample.whole = segment.whole < 0 ? -1 : static_cast<int>(first) + segment.whole;
    for (const std::uint32_t i : segment.points)
      sample.place += Vector2(static_cast<double>(found.x[i]), static_cast<double>(found.y[i]));
    sample.place /= static_cast<double>(segment.points.size());
    const Vector3 world = frame.ego.T_world_ego * Vector3(sample.place.x(), sample.place.y(), 0);
    const Vector2 seen = (frame.T_world_sensor().translation() - world).head<2>();
    sample.view = {std::atan2(seen.y(), seen.x()), std::log(std::max(seen.norm(), 0.1))};
    samples_.clusters.push_back(sample);
    points_.push_back(std::move(segment.points));
  }
  if (labels) {
    addByLabels(found, *labels, first);
  } else {
    addByBoxes(frame, found, *instant, first);
  }
  nameThings(frame, first);
}

/// Things within half a meter of one of the frame before are that one.
void ClusterSampler::nameThings(const SensorFrame& frame, std::size_t first) {
  constexpr double kSame = 0.5;  // [m]
  std::vector<std::pair<Vector2, std::int64_t>> now;
  for (std::size_t c = first; c < samples_.clusters.size(); ++c) {
    ClusterSample& s = samples_.clusters[c];
    if (s.kind != ClusterKind::kThing || s.whole >= 0) continue;
    const Vector2 place = (frame.ego.T_world_ego * Vector3(s.place.x(), s.place.y(), 0)).head<2>();
    const auto same = std::find_if(things_.begin(), things_.end(), [&](const auto& thing) {
      return (thing.first - place).norm() < kSame;
    });
    s.object = same == things_.end() ? next_thing_-- : same->second;
    now.emplace_back(place, s.object);
  }
  things_ = std::move(now);
}

void ClusterSampler::addByBoxes(const SensorFrame& frame, const LidarDetections& found,
                                const GroundTruth::Instant& instant, std::size_t first) {
  const std::size_t returns = found.obstacles.size(), clusters = points_.size();
  const std::vector<Vector3> places = placesInWorld(frame, found);
  struct Best {
    double share = 0, sum = 0, of_object = 0;  // of_object: of the best's returns, those in it
    const TruthObject* object = nullptr;
    bool most_of_one = false;
  };
  std::vector<Best> best(clusters);
  std::vector<char> in(returns);
  for (const TruthObject& o : instant.objects) {
    if (!hasBox(o)) continue;
    const GrownBox box(o, rules_.box_margin);
    std::size_t on_it = 0;
    for (std::size_t i = 0; i < returns; ++i) on_it += in[i] = box.holds(places[i]);
    if (on_it == 0) continue;
    const Vector3 center = frame.ego.T_world_ego.inverse() * o.position;
    ObjectView view;
    const auto kind = kindOfTruth(o.type);
    view.log = log_, view.frame = frame.frame, view.object = o.id;
    view.range = center.head<2>().norm(), view.returns = on_it;
    for (std::size_t c = 0; c < clusters; ++c) {
      const auto inside = static_cast<double>(
          std::count_if(points_[c].begin(), points_[c].end(), [&](auto i) { return in[i]; }));
      if (inside == 0) continue;
      const auto size = static_cast<double>(points_[c].size()), of = static_cast<double>(on_it);
      const double share = inside / size, overlap = inside / (size + of - inside);
      best[c].sum += share;
      best[c].most_of_one = best[c].most_of_one || (kind && inside / of > rules_.grown);
      if (share > best[c].share)
        best[c].share = share, best[c].of_object = inside / of, best[c].object = &o;
      if (overlap > view.overlap) view.overlap = overlap, view.sample = static_cast<int>(first + c);
    }
    const bool ahead = std::abs(std::atan2(center.y(), center.x())) < rules_.fov / 2;
    if (!kind || view.range > rules_.range || !ahead) continue;
    view.kind = *kind;
    samples_.objects.push_back(view);
  }
  for (std::size_t c = 0; c < clusters; ++c) {
    ClusterSample& sample = samples_.clusters[first + c];
    const bool ahead =
        std::abs(std::atan2(sample.place.y(), sample.place.x())) < rules_.fov / 2 - radians(2);
    if (sample.place.norm() > rules_.range) continue;
    if (best[c].share >= rules_.mostly && best[c].of_object < rules_.fragment) {
      if (kindOfTruth(best[c].object->type)) sample.kind = ClusterKind::kMixed;
    } else if (best[c].share >= rules_.mostly) {
      sample.kind = kindOfTruth(best[c].object->type);
      sample.object = best[c].object->id;
    } else if (best[c].most_of_one) {
      sample.kind = ClusterKind::kMixed;
    } else if (best[c].sum < rules_.hardly && ahead) {
      sample.kind = ClusterKind::kThing;
    }
  }
}

void ClusterSampler::addByLabels(const LidarDetections& found,
                                 const std::vector<std::uint16_t>& labels, std::size_t first) {
  const auto kindAt = [&](std::uint32_t i) {
    return kindOfLabel(labels[found.points.source[found.obstacles[i]]]);
  };
  for (std::size_t c = 0; c < points_.size(); ++c) {
    ClusterSample& sample = samples_.clusters[first + c];
    if (sample.place.norm() > rules_.range) continue;
    std::array<double, kClusterKinds> share{};
    double unlabelled = 0;
    for (const std::uint32_t i : points_[c]) {
      if (const auto kind = kindAt(i)) share[static_cast<std::size_t>(*kind)] += 1;
      unlabelled += labels[found.points.source[found.obstacles[i]]] == 0;
    }
    double all = unlabelled;
    for (double& s : share) all += s;
    const auto size = static_cast<double>(points_[c].size());
    const auto most = std::max_element(share.begin(), share.end());
    if (*most / size >= rules_.mostly) {
      sample.kind = static_cast<ClusterKind>(most - share.begin());
    } else if (all / size < rules_.hardly) {
      sample.kind = ClusterKind::kThing;
    }
  }
}

}  // namespace perception
