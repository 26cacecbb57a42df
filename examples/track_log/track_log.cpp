// track_log INI LOG: tracks a rawlog and prints the road users of every scene.
#include <cstdio>
#include <exception>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

using namespace perception;

void print(const Scene& scene, const ClassTable& classes) {
  std::printf("%.3f s: %zu objects\n", scene.stamp.seconds(), scene.objects.size());
  for (const SceneObject& object : scene.objects) {
    const ObjectClass& type = classes[object.class_id];
    if (type.reported && object.classified)
      std::printf("  %llu %s at (%.1f, %.1f) m, %.1f m/s\n",
                  static_cast<unsigned long long>(object.id), type.name.c_str(),
                  object.position.x(), object.position.y(), object.speed);
  }
}

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: track_log INI LOG\n", stderr), 64;
  registerPerceptionClasses();
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(PipelineSetup::fromFile(argv[1], {}), events, timing);
  const auto take = [&](bool end) {
    while (const auto scene = pipeline.next(end)) print(*scene, pipeline.setup().model.classes);
  };
  RawlogReader log(argv[2]);
  while (const auto observation = log.next()) pipeline.add(*observation), take(false);
  take(true);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "track_log: error: %s\n", error.what()), 65;
}
