// Recall and precision of the lidar's detections, by size and by class, on recordings with labels:
// KITTI tracking 0000 (boxes) and WADS 36 in falling snow (a class per return; objects are groups
// of such returns), without and with point trust, beside [radecki2016]'s figures. What is missed
// and what the false ones are is counted by kind. Markdown.
#include <fmt/format.h>

#include <map>
#include <set>

#include "libperception/importers/kitti/KittiLabels.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/outline/BoxFit.h"
#include "libperception/weather/PointFilter.h"
#include "tests/bench/speed/LidarScans.h"

namespace perception::bench {
namespace {

constexpr double kNear = 0.75;     // [m] from a detection's middle to its object's outline
constexpr int kLeastReturns = 20;  // of an object that counts
// Of what passes for a car or a person by its size.
constexpr double kCarLength[] = {2.5, 8};  // [m]
constexpr float kCarTop = 2.6F;            // [m] above ground
constexpr float kPersonSpan = 1.0F;        // [m] lowest to highest return

enum class Kind { kVehicle, kPerson, kRider };

/// Something labeled. Ego frame.
struct Truth {
  Kind kind = Kind::kVehicle;
  std::vector<Vector2> outline;  ///< [m]
  bool counts = false;           ///< near enough, with enough returns
};

/// A detection, and what it lies on where no truth object is.
struct Seen {
  enum Label { kStable, kUnstable, kPerson };
  Label label = kStable;
  Vector2 place = Vector2::Zero();  ///< [m]
  bool right_size = false;
  std::string nature;
};

/// One row of the table.
struct Row {
  std::size_t truths = 0, found = 0;
  std::size_t otherwise = 0;  ///< of those not found: under another label
  std::size_t detections = 0, right_size = 0, right_class = 0;
  std::map<std::string, std::size_t> missed, false_ones;
};

std::string share(std::size_t part, std::size_t whole) {
  if (whole == 0) return "n/a";
  return fmt::format("{:.0f} % ({}/{})",
                     100.0 * static_cast<double>(part) / static_cast<double>(whole), part, whole);
}

std::string listed(const std::map<std::string, std::size_t>& kinds) {
  std::string text;
  for (const auto& [kind, count] : kinds)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, kind);
  return text.empty() ? "none" : text;
}

/// What a scan's labels say.
class Labels {
 public:
  virtual ~Labels() = default;
  virtual std::vector<Truth> truths(const RecordedScan& scan, double range) const = 0;
  /// What detected returns are, where no truth object is near; indices into the scan's cloud.
  virtual std::string natureOf(const RecordedScan& scan, const std::vector<std::uint32_t>& returns,
                               const std::string& shape) const = 0;
  virtual double fov() const = 0;  ///< [rad] that the labels cover
};

/// Boxes of KITTI's tracking benchmark: of road users in the camera's view.
class KittiBoxes final : public Labels {
 public:
  KittiBoxes()
      : labels_(readKittiLabels(recording("kitti_tracking/label_02/0000.txt"))),
        calibration_(readKittiCalibration(recording("kitti_tracking/calib/0000.txt"))) {}

  std::vector<Truth> truths(const RecordedScan& scan, double range) const override {
    static const std::map<std::string, Kind> kKinds = {
        {"Car", Kind::kVehicle},       {"Van", Kind::kVehicle},   {"Truck", Kind::kVehicle},
        {"Tram", Kind::kVehicle},      {"Person", Kind::kPerson}, {"Person_sitting", Kind::kPerson},
        {"Pedestrian", Kind::kPerson}, {"Cyclist", Kind::kRider}};
    std::vector<Truth> truths;
    for (const KittiLabel& label : labels_) {
      const auto kind = kKinds.find(label.type);
      if (label.frame != scan.number || !label.box || kind == kKinds.end()) continue;
      const auto box = boxInVelodyne(*label.box, calibration_);
      Truth truth;
      truth.kind = kind->second;
      for (const Vector2& sign : {Vector2(1, 1), Vector2(-1, 1), Vector2(-1, -1), Vector2(1, -1)})
        truth.outline.push_back(
            box.bottom_center.head<2>() +
            rotate2(box.yaw, {sign.x() * box.length / 2, sign.y() * box.width / 2}));
      const auto& cloud = std::get<LidarCloud>(scan.frame.data);
      truth.counts = label.occluded <= 2 && box.bottom_center.head<2>().norm() <= range &&
                     returnsInside(*label.box, cloud, calibration_) >= kLeastReturns;
      truths.push_back(std::move(truth));
    }
    return truths;
  }
  std::string natureOf(const RecordedScan&, const std::vector<std::uint32_t>&,
                       const std::string& shape) const override {
    return shape;
  }
  double fov() const override { return radians(76); }

 private:
  std::vector<KittiLabel> labels_;
  KittiCalibration calibration_;
};

/// Classes of WADS's returns.
class WadsClasses final : public Labels {
 public:
  std::vector<Truth> truths(const RecordedScan& scan, double range) const override {
    std::vector<Truth> truths;
    gather(scan, {10, 20}, Kind::kVehicle, range, truths);
    gather(scan, {30}, Kind::kPerson, range, truths);
    return truths;
  }
  std::string natureOf(const RecordedScan& scan, const std::vector<std::uint32_t>& returns,
                       const std::string&) const override {
    static const std::map<std::uint16_t, const char*> kNames = {
        {0, "unlabeled"}, {10, "car"},   {20, "car"},           {30, "person"},
        {40, "road"},     {50, "wall"},  {70, "bush"},          {80, "pole"},
        {81, "sign"},     {99, "thing"}, {110, "falling snow"}, {111, "lying snow"}};
    std::map<std::uint16_t, std::size_t> votes;
    for (const std::uint32_t i : returns) ++votes[scan.point_class[i]];
    const auto most =
        std::max_element(votes.begin(), votes.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == votes.end() ? "unlabeled" : kNames.at(most->first);
  }
  double fov() const override { return kTwoPi; }

 private:
  // Groups of returns, 0.7 m apart at most.
  static void gather(const RecordedScan& scan, const std::set<std::uint16_t>& classes, Kind kind,
                     double range, std::vector<Truth>& truths) {
    std::vector<float> x, y, height;
    const auto& cloud = std::get<LidarCloud>(scan.frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (classes.count(scan.point_class[i]) == 0) continue;
      x.push_back(cloud.x[i]), y.push_back(cloud.y[i]), height.push_back(1.5F);
    }
    ClusterParams params;
    params.near_threshold = 0.7, params.far_threshold = 0.71, params.min_top = 0;
    params.min_points = 1, params.min_side = params.unstable_min_side = 0;
    params.min_area = 0, params.max_size = params.unstable_max_size = 100;
    for (const Cluster& group : findClusters(x, y, height, params))
      truths.push_back({kind, group.hull,
                        group.points.size() >= static_cast<std::size_t>(kLeastReturns) &&
                            group.centroid.norm() <= range});
  }
};

std::vector<Seen> detectionsOf(const RecordedScan& scan, const LidarDetections& found,
                               const Labels& labels) {
  const auto sources = [&](const std::vector<std::uint32_t>& points) {
    std::vector<std::uint32_t> returns;
    for (const std::uint32_t i : points) returns.push_back(found.points.source[found.obstacles[i]]);
    return returns;
  };
  std::vector<Seen> all;
  for (const Cluster& c : found.clusters) {
    const double length = sizeOf(c.hull).longest;
    const std::string shape = c.highest > kCarTop      ? "higher than 2.6 m"
                              : length > kCarLength[1] ? "longer than 8 m"
                              : length < kCarLength[0] ? "shorter than 2.5 m"
                                                       : "of a car's size";
    all.push_back({c.stable ? Seen::kStable : Seen::kUnstable, c.centroid,
                   shape == "of a car's size", labels.natureOf(scan, sources(c.points), shape)});
  }
  for (const PersonPeak& p : found.persons) {
    const bool tall = p.highest - p.lowest >= kPersonSpan;
    const std::string shape = tall ? "of a person's height" : "lower";
    all.push_back({Seen::kPerson, p.center, tall, labels.natureOf(scan, sources(p.points), shape)});
  }
  return all;
}

// Why nothing was found: too little of the object stands above the ground, or it was joined.
std::string whyMissed(const LidarDetections& found, const Truth& truth) {
  std::size_t obstacles = 0;
  float top = 0;
  for (std::size_t i = 0; i < found.x.size(); ++i) {
    const Vector2 place(static_cast<double>(found.x[i]), static_cast<double>(found.y[i]));
    if (distanceToHull(truth.outline, place) > 0.05) continue;
    ++obstacles, top = std::max(top, found.above[i]);
  }
  if (obstacles < 7) return "with less than 7 obstacle returns";
  return top <= 1 ? "lower than 1 m" : "joined to something else";
}

/// All scans of a recording; `rows`: [radecki2016]'s rule, clusters of both kinds, persons.
std::array<Row, 3> score(const std::vector<RecordedScan>& scans, const Labels& labels, bool trust,
                         double range) {
  LidarParams params;
  params.points.vehicle_front = params.points.vehicle_rear = 2.6;  // [m] both vehicles
  const LidarFrontEnd lidar = frontEnd(params);
  WeatherParams weather;
  weather.filter = trust ? "trust" : "off";
  const auto filter = makePointFilter(weather);
  GroundEstimator ground;
  std::array<Row, 3> rows;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = ground.update(frame);
    if (filter) filter->apply(frame);
    const LidarDetections found = lidar.detect(frame);
    const auto truths = labels.truths(scan, range);
    const auto seen = detectionsOf(scan, found, labels);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const bool persons = r == 2;
      const auto belongs = [&](const Seen& s) {
        return persons ? s.label == Seen::kPerson
                       : s.label == Seen::kStable || (r == 1 && s.label == Seen::kUnstable);
      };
      const Kind wanted = persons ? Kind::kPerson : Kind::kVehicle;
      for (const Truth& truth : truths) {
        if (!truth.counts || truth.kind != wanted) continue;
        const bool hit = std::any_of(seen.begin(), seen.end(), [&](const Seen& s) {
          return belongs(s) && distanceToHull(truth.outline, s.place) <= kNear;
        });
        ++rows[r].truths, rows[r].found += hit;
        if (hit) continue;
        const bool otherwise = std::any_of(seen.begin(), seen.end(), [&](const Seen& s) {
          return distanceToHull(truth.outline, s.place) <= kNear;
        });
        rows[r].otherwise += otherwise;
        if (!otherwise) ++rows[r].missed[whyMissed(found, truth)];
      }
      for (const Seen& s : seen) {
        if (!belongs(s) || s.place.norm() > range ||
            std::abs(std::atan2(s.place.y(), s.place.x())) > labels.fov() / 2)
          continue;
        bool right = false, rider = false;
        for (const Truth& truth : truths) {
          if (distanceToHull(truth.outline, s.place) > kNear) continue;
          right |= truth.kind == wanted, rider |= truth.kind == Kind::kRider;
        }
        ++rows[r].detections;
        rows[r].right_class += right, rows[r].right_size += right || rider || s.right_size;
        if (!right) ++rows[r].false_ones[rider ? "rider" : s.nature];
      }
    }
  }
  return rows;
}

void print(const std::string& name, const std::array<Row, 3>& rows) {
  const char* names[] = {"car-sized, alone within 1 m", "car-sized, all", "person-sized"};
  for (std::size_t r = 0; r < rows.size(); ++r)
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", name, names[r],
               share(rows[r].found, rows[r].truths),
               share(rows[r].found + rows[r].otherwise, rows[r].truths),
               share(rows[r].right_size, rows[r].detections),
               share(rows[r].right_class, rows[r].detections), listed(rows[r].missed),
               listed(rows[r].false_ones));
  std::fflush(stdout);
}

int run() {
  const auto front = kittiFront(), snow = wads();
  if (front.empty() || snow.empty()) {
    fmt::print("skipped: no recordings in {}\n", recording(""));
    return 0;
  }
  fmt::print(
      "KITTI 0000: {} scans, labels of road users in 76 deg; WADS 36: {} scans in falling snow, "
      "360 "
      "deg. Objects with {} returns.\n\n| scans | detections | recall | seen at all | precision, "
      "size | "
      "precision, class | never seen | false by class |\n|---|---|---|---|---|---|---|---|\n",
      front.size(), snow.size(), kLeastReturns);
  fmt::print(
      "| paper, sunny, 70 m | car-sized | 91 % | | 79 % | 51 % | | shrubs, buildings |\n"
      "| paper, sunny, 70 m | person-sized | 88 % | | 89 % | 55 % | | signs, posts, poles |\n");
  const KittiBoxes boxes;
  const WadsClasses point_classes;
  for (const double range : {20.0, 70.0})
    print(fmt::format("KITTI, {:.0f} m", range), score(front, boxes, false, range));
  for (const double range : {20.0, 50.0})
    for (const bool trust : {false, true})
      print(fmt::format("WADS, {:.0f} m{}", range, trust ? ", trust" : ""),
            score(snow, point_classes, trust, range));
  return 0;
}

}  // namespace
}  // namespace perception::bench

int main() { return perception::bench::run(); }
