// Data that comes late, and scenes that come late on purpose.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <memory>
#include <set>

#include "libperception/core/math/Random.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/input/FrameQueue.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

using Log = std::vector<std::shared_ptr<mrpt::obs::CObservation>>;

SensorFrame lateFrame(const std::string& label, double t) {
  SensorFrame frame;
  frame.sensor = label;
  frame.stamp = Stamp::fromSeconds(1000) + t;
  return frame;
}

std::string order(FrameQueue& queue) {
  std::string out;
  while (true) {
    const auto frames = queue.pop(true);
    if (frames.empty()) return out;
    for (const auto& f : frames) out += f.sensor;
    out += ' ';
  }
}

TEST(FrameQueue, OrderOfArrivalDoesNotMatterWithinTheWindow) {
  std::vector<SensorFrame> frames = {lateFrame("A", 0), lateFrame("B", 0.05), lateFrame("C", 0.1),
                                     lateFrame("a", 0.1), lateFrame("D", 0.19)};
  const auto before = [](const SensorFrame& a, const SensorFrame& b) {
    return a.sensor < b.sensor;
  };
  std::sort(frames.begin(), frames.end(), before);
  int orders = 0;
  do {
    FrameQueue queue({0.2, 70});
    for (const auto& f : frames) {
      ASSERT_EQ(queue.push(f), FrameQueue::Verdict::kTaken);
      ASSERT_TRUE(queue.pop(false).empty());
    }
    ASSERT_EQ(order(queue), "A B Ca D ");
    ++orders;
  } while (std::next_permutation(frames.begin(), frames.end(), before));
  EXPECT_EQ(orders, 120);
}

TEST(FrameQueue, HoldsAFrameForTheWindowAndDropsWhatIsOlderThanTheLastOneGiven) {
  FrameQueue queue({0.2, 70});
  queue.push(lateFrame("A", 0));
  queue.advance(Stamp::fromSeconds(1000) + 0.2);
  EXPECT_TRUE(queue.pop(false).empty());
  queue.advance(Stamp::fromSeconds(1000) + 0.2001);
  EXPECT_EQ(queue.pop(false).size(), 1u);
  EXPECT_EQ(queue.push(lateFrame("B", -0.01)), FrameQueue::Verdict::kTooLate);
  EXPECT_EQ(queue.push(lateFrame("B", 0)), FrameQueue::Verdict::kTooLate);
  // Older than the window, but nothing newer was given yet: still of use.
  EXPECT_EQ(queue.push(lateFrame("B", 0.001)), FrameQueue::Verdict::kTaken);
  EXPECT_EQ(queue.push(lateFrame("B", 0.001)), FrameQueue::Verdict::kDuplicate);
}

TEST(FrameQueue, HoldsSeventyFramesAtMost) {
  FrameQueue queue({0.2, 70});
  for (int i = 0; i < 70; ++i) {
    queue.push(lateFrame("A", 0.001 * i));
    ASSERT_TRUE(queue.pop(false).empty()) << i;
  }
  queue.push(lateFrame("A", 0.07));
  const auto oldest = queue.pop(false);
  ASSERT_EQ(oldest.size(), 1u);
  EXPECT_EQ(oldest[0].stamp, Stamp::fromSeconds(1000));
  EXPECT_TRUE(queue.pop(false).empty());
}

/// The simulated demo log's first seconds, in order of time.
Log demoLogOf(double seconds) {
  registerPerceptionClasses();
  Log out;
  RawlogReader reader(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog");
  while (auto o = reader.next()) {
    if (!out.empty() && *toStamp(o->timestamp) - *toStamp(out.front()->timestamp) > seconds) break;
    out.push_back(std::move(o));
  }
  return out;
}
const Log& demoLog() {
  static const Log log = demoLogOf(5);
  return log;
}

struct Tracked {
  std::vector<Scene> scenes;
  std::vector<SensorRecord> sensors;
  std::map<std::string, std::uint64_t> events;
  std::string text;  // of all scenes, every bit
};

Tracked track(const Log& log, const std::string& setting = "") {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/demo.ini");
  if (!setting.empty()) config.set(setting);
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  Tracked out;
  const auto take = [&](bool flush) {
    while (auto scene = pipeline.next(flush)) out.scenes.push_back(std::move(*scene));
  };
  for (const auto& o : log) pipeline.add(*o), take(false);
  take(true);
  pipeline.finish();
  out.sensors = pipeline.sensorRecords();
  for (const auto& [kind, n] : events.counts()) out.events[kind] = n;
  for (const Scene& s : out.scenes) {
    out.text += fmt::format("{} {}\n", s.stamp.ns, s.frame);
    for (const auto& o : s.objects) {
      out.text += fmt::format("{} {} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a}\n", o.id, o.class_id,
                              o.existence, o.position.x(), o.position.y(), o.yaw, o.speed, o.length,
                              o.sd_x, o.class_probability[0]);
    }
  }
  return out;
}

TEST(LateData, WithinTheWindowTheResultIsThatOfTheSortedLogToTheBit) {
  const Tracked sorted = track(demoLog());
  ASSERT_GT(sorted.scenes.size(), 40u);
  for (const std::uint64_t seed : {1u, 2u}) {
    Rng rng({seed, 0, 0, 0x1a7e});
    std::vector<std::pair<std::int64_t, std::shared_ptr<mrpt::obs::CObservation>>> arrivals;
    for (std::size_t i = 0; i < demoLog().size(); ++i) {
      const double delay = i < 3 ? 0 : 0.15 * rng.uniform();  // [s] the log begins with its clock
      arrivals.emplace_back((*toStamp(demoLog()[i]->timestamp) + delay).ns, demoLog()[i]);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Log mixed;
    for (auto& a : arrivals) mixed.push_back(std::move(a.second));
    ASSERT_NE(mixed, demoLog());
    const Tracked late = track(mixed);
    EXPECT_EQ(late.text, sorted.text);
    EXPECT_EQ(late.events, sorted.events);
  }
}

TEST(LateData, FramesBeforeOdometryHasAMotionWaitForIt) {
  const Log start(demoLog().begin(), demoLog().begin() + 60);
  const Tracked given = track(start), odometry = track(start, "ego.source=lidar");
  ASSERT_GT(odometry.scenes.size(), 2u);
  EXPECT_EQ(odometry.scenes.size(), given.scenes.size());
  EXPECT_EQ(odometry.events.count("ego_gap"), 0u) << odometry.text;
  const Vector2 first = odometry.scenes[0].ego.velocity;
  EXPECT_GT(first.norm(), 1);
  EXPECT_EQ(first, odometry.scenes[1].ego.velocity);  // of the way between them
}

TEST(LateData, OneScanAloneIsUsedAtTheEndOfTheLog) {
  Log start;
  for (const auto& o : demoLog()) {
    if (o->sensorLabel == "LIDAR_TOP" && !start.empty() &&
        std::any_of(start.begin(), start.end(),
                    [](const auto& b) { return b->sensorLabel == "LIDAR_TOP"; }))
      break;
    start.push_back(o);
  }
  EXPECT_EQ(track(start, "ego.source=lidar").scenes.size(), track(start).scenes.size());
}

TEST(LateData, BeyondTheWindowIsDroppedAndCountedAtItsSensor) {
  Log late, without;
  std::shared_ptr<mrpt::obs::CObservation> held;
  int frames = 0;
  for (const auto& o : demoLog()) {
    if (o->sensorLabel == "CAMERA" && ++frames == 10) {
      held = o;
      continue;
    }
    without.push_back(o);
    late.push_back(o);
    // Comes 0.5 s after its time.
    if (held && *toStamp(o->timestamp) - *toStamp(held->timestamp) > 0.5)
      late.push_back(std::exchange(held, nullptr));
  }
  ASSERT_EQ(late.size(), demoLog().size());
  const Tracked dropped = track(late), never = track(without);
  EXPECT_EQ(dropped.text, never.text);
  EXPECT_NE(dropped.text, track(demoLog()).text);
  EXPECT_EQ(dropped.events.at(event_kind::kOutOfOrder), 1u);
  for (std::size_t i = 0; i < dropped.sensors.size(); ++i) {
    const bool camera = dropped.sensors[i].label == "CAMERA";
    EXPECT_EQ(dropped.sensors[i].dropped_frames, never.sensors[i].dropped_frames + camera);
  }
}

/// The demo log without what was seen between 2 and 5 s, with or without the vehicle's poses.
Log holedLog(bool poses) {
  Log out;
  for (const auto& o : demoLog()) {
    const double t = *toStamp(o->timestamp) - *toStamp(demoLog().front()->timestamp);
    if (isSensorData(*o) ? t < 2 || t > 4.5 : poses) out.push_back(o);
  }
  return out;
}

TEST(BlindGap, TracksStartAnewWhereNothingTellsHowTheVehicleMoved) {
  const auto survivors = [](const Tracked& run) {
    std::set<std::uint64_t> before, both;
    const Stamp start = run.scenes.front().stamp;
    for (const Scene& scene : run.scenes)
      for (const auto& object : scene.objects) {
        if (scene.stamp - start < 3) before.insert(object.id);
        if (scene.stamp - start > 3 && before.count(object.id) > 0) both.insert(object.id);
      }
    return both.size();
  };
  const Tracked blind = track(holedLog(false)), seeing = track(holedLog(true));
  ASSERT_GT(blind.scenes.back().stamp - blind.scenes.front().stamp, 4.4);
  EXPECT_EQ(survivors(blind), 0u);
  EXPECT_GT(survivors(seeing), 0u);
  EXPECT_GT(survivors(track(holedLog(false), "ego.blind_gap=10")), 0u);
}

TEST(OutputLag, EveryInstantComesOnceAndIsTheSameForAnyThreads) {
  const Tracked causal = track(demoLog());
  std::string first;
  for (const std::size_t threads : {1u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Tracked lagged = track(demoLog(), "run.output_lag=0.5");
    ASSERT_EQ(lagged.scenes.size(), causal.scenes.size());
    for (std::size_t i = 0; i < causal.scenes.size(); ++i) {
      ASSERT_EQ(lagged.scenes[i].stamp, causal.scenes[i].stamp);
      ASSERT_EQ(lagged.scenes[i].frame, causal.scenes[i].frame);
    }
    if (first.empty()) first = lagged.text;
    EXPECT_EQ(lagged.text, first);
  }
  EXPECT_NE(first, causal.text);
}

TEST(OutputLag, AStopDoesNotWaitForWhatIsKnownLater) {
  const Log log = demoLogOf(11);  // at its end a vehicle is in the way
  const Tracked causal = track(log), lagged = track(log, "run.output_lag=0.5");
  ASSERT_EQ(lagged.scenes.size(), causal.scenes.size());
  std::size_t blocked = 0;
  for (std::size_t i = 0; i < causal.scenes.size(); ++i) {
    ASSERT_EQ(lagged.scenes[i].path.has_value(), causal.scenes[i].path.has_value()) << i;
    if (!causal.scenes[i].path) continue;
    const FreePath &late = *lagged.scenes[i].path, &at_once = *causal.scenes[i].path;
    EXPECT_EQ(late.stop, at_once.stop) << i;
    EXPECT_EQ(late.cause, at_once.cause) << i;
    EXPECT_EQ(late.safe_speed, at_once.safe_speed) << i;
    blocked += at_once.blocked;
  }
  EXPECT_GT(blocked, 0u);
}

TEST(OutputLag, NothingIsLeftToSmoothInTheLastScene) {
  const auto places = [](const Scene& scene) {
    std::vector<std::pair<double, double>> out;
    for (const auto& o : scene.objects) out.emplace_back(o.position.x(), o.position.y());
    std::sort(out.begin(), out.end());
    return out;
  };
  const auto causal = places(track(demoLog()).scenes.back());
  EXPECT_FALSE(causal.empty());
  EXPECT_EQ(places(track(demoLog(), "run.output_lag=0.5").scenes.back()), causal);
}

}  // namespace
}  // namespace perception
