#include "libperception/interop/exports/NuscenesFile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

using ResultJson = nlohmann::ordered_json;
constexpr std::size_t kMostBoxes = 500;  // of a sample, by the benchmark's rules

std::map<std::uint64_t, double> meanExistence(const TrackedRun& run) {
  std::map<std::uint64_t, std::pair<double, double>> sums;
  for (const Scene& scene : run.scenes)
    for (const SceneObject& o : scene.objects) sums[o.id].first += o.existence, ++sums[o.id].second;
  std::map<std::uint64_t, double> means;
  for (const auto& [id, sum] : sums) means[id] = sum.first / sum.second;
  return means;
}

ResultJson resultBox(const SceneObject& o, const std::string& token, const std::string& name,
                     double score, const Pose3& T_global_world) {
  const Vector3 center = T_global_world * (o.position + Vector3(0, 0, o.height / 2));
  const Eigen::Matrix3d R = T_global_world.linear() * makePose(0, 0, 0, o.yaw).linear();
  const Eigen::Quaterniond q(R);
  const Vector3 v = T_global_world.linear() * Vector3(o.velocity.x(), o.velocity.y(), 0);
  return {{"sample_token", token},
          {"translation", {center.x(), center.y(), center.z()}},
          {"size", {o.width, o.length, o.height}},
          {"rotation", {q.w(), q.x(), q.y(), q.z()}},
          {"velocity", {v.x(), v.y()}},
          {"tracking_id", std::to_string(o.id)},
          {"tracking_name", name},
          {"tracking_score", score}};
}

// What the benchmark wants to know of the input.
ResultJson metaOf(const TrackedRun& run) {
  std::string letters;
  for (const Scene& scene : run.scenes)
    for (const SceneObject& o : scene.objects)
      for (const auto& hit : o.last_hit) letters += letterOf(hit.first);
  const auto uses = [&](char letter) { return letters.find(letter) != std::string::npos; };
  return {{"use_camera", uses('C')},
          {"use_lidar", uses('L')},
          {"use_radar", uses('R')},
          {"use_map", false},
          {"use_external", false}};
}

}  // namespace

std::string samplesFileOf(const std::string& rawlog) {
  return std::filesystem::path(rawlog).replace_extension(".samples.csv").string();
}

void writeNuscenesSamples(const std::string& path, const NuscenesSamples& samples) {
  const Vector3 t = samples.T_global_world.translation();
  const Eigen::Quaterniond q(samples.T_global_world.linear());
  std::string text = "frame,sample_token,x,y,z,qw,qx,qy,qz\n";
  for (const auto& [frame, token] : samples.tokens)
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", frame, token, t.x(), t.y(), t.z(), q.w(),
                        q.x(), q.y(), q.z());
  writeFile(path, text);
}

NuscenesSamples readNuscenesSamples(const std::string& path) {
  const CsvTable table = CsvTable::fromFile(path);
  const auto real = [&](std::size_t row, const char* name) {
    return table.real(row, table.column(name));
  };
  NuscenesSamples samples;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    samples.tokens.emplace_back(table.integer(row, table.column("frame")),
                                table.text(row, table.column("sample_token")));
    if (row > 0) continue;
    const Eigen::Quaterniond q(real(row, "qw"), real(row, "qx"), real(row, "qy"), real(row, "qz"));
    if (!(std::abs(q.norm() - 1) < 1e-3)) table.fault(row, table.column("qw"), "a unit quaternion");
    samples.T_global_world.linear() = q.normalized().toRotationMatrix();
    samples.T_global_world.translation() = Vector3(real(row, "x"), real(row, "y"), real(row, "z"));
  }
  return samples;
}

std::uint64_t writeNuscenesTracks(const std::string& path, const TrackedRun& run,
                                  const std::map<std::uint64_t, std::string>& names,
                                  const NuscenesSamples& samples) {
  const auto scores = meanExistence(run);
  std::map<std::int64_t, const Scene*> scenes;
  for (const Scene& scene : run.scenes)
    if (scene.frame >= 0) scenes.emplace(scene.frame, &scene);
  ResultJson results = ResultJson::object();
  std::uint64_t count = 0;
  for (const auto& [frame, token] : samples.tokens) {
    ResultJson& boxes = results[token] = ResultJson::array();
    const auto scene = scenes.find(frame);
    if (scene == scenes.end()) continue;
    std::vector<const SceneObject*> objects;
    for (const SceneObject& o : scene->second->objects) {
      const auto name = names.find(o.id);
      if (name != names.end() && !name->second.empty()) objects.push_back(&o);
    }
    std::stable_sort(objects.begin(), objects.end(), [&](const auto* a, const auto* b) {
      return scores.at(a->id) > scores.at(b->id);
    });
    objects.resize(std::min(objects.size(), kMostBoxes));
    for (const SceneObject* o : objects)
      boxes.push_back(
          resultBox(*o, token, names.at(o->id), scores.at(o->id), samples.T_global_world));
    count += objects.size();
  }
  writeFile(path, ResultJson{{"meta", metaOf(run)}, {"results", results}}.dump(1) + "\n");
  return count;
}

}  // namespace perception
