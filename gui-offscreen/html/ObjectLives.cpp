#include "gui-offscreen/html/ObjectLives.h"

#include <algorithm>

namespace perception {

ObjectLives::ObjectLives(const RunOutline& run) : first_stamp_(run.first_stamp) {
  if (run.stamps.size() > 1) {
    period_ = (run.stamps.back() - run.stamps.front()) / static_cast<double>(run.stamps.size() - 1);
  }
}

void ObjectLives::add(const Scene& scene) {
  const double t = scene.stamp - first_stamp_;
  for (const SceneObject& o : scene.objects) {
    ObjectLife& life = lives_[o.id];
    life.id = o.id;
    const bool goes_on = !life.stretches.empty() && life.last_class == o.class_id &&
                         life.stretches.back().sure == o.classified &&
                         t - life.stretches.back().to < 2.5 * period_;
    if (!goes_on) life.stretches.push_back({t, t, o.class_id, o.classified});
    life.stretches.back().to = t + period_;
    life.last_seen = t;
    life.last_class = o.class_id;
    const auto c = static_cast<std::size_t>(o.class_id);
    life.probability = c < o.class_probability.size() ? o.class_probability[c] : 0;
    life.top_speed = std::max(life.top_speed, o.velocity.norm());
    life.nearest =
        std::min(life.nearest, (o.position - scene.ego.T_world_ego.translation()).head<2>().norm());
  }
}

std::vector<ObjectLife> ObjectLives::list() const {
  std::vector<ObjectLife> list;
  for (const auto& [id, life] : lives_) list.push_back(life);
  return list;
}

}  // namespace perception
