#include "gui-offscreen/html/ObjectLives.h"

#include <algorithm>
#include <map>

namespace perception {

std::vector<ObjectLife> objectLives(const TrackedRun& run) {
  std::map<std::uint64_t, ObjectLife> lives;
  double period = 0.1;
  if (run.scenes.size() > 1) {
    period = (run.scenes.back().stamp - run.scenes.front().stamp) /
             static_cast<double>(run.scenes.size() - 1);
  }
  for (const Scene& scene : run.scenes) {
    const double t = scene.stamp - run.first_stamp;
    for (const SceneObject& o : scene.objects) {
      ObjectLife& life = lives[o.id];
      life.id = o.id;
      const bool goes_on = !life.stretches.empty() && life.last_class == o.class_id &&
                           life.stretches.back().sure == o.classified &&
                           t - life.stretches.back().to < 2.5 * period;
      if (!goes_on) life.stretches.push_back({t, t, o.class_id, o.classified});
      life.stretches.back().to = t + period;
      life.last_seen = t;
      life.last_class = o.class_id;
      const auto c = static_cast<std::size_t>(o.class_id);
      life.probability = c < o.class_probability.size() ? o.class_probability[c] : 0;
      life.top_speed = std::max(life.top_speed, o.velocity.norm());
      life.nearest = std::min(life.nearest,
                              (o.position - scene.ego.T_world_ego.translation()).head<2>().norm());
    }
  }
  std::vector<ObjectLife> list;
  for (auto& [id, life] : lives) list.push_back(std::move(life));
  return list;
}

}  // namespace perception
