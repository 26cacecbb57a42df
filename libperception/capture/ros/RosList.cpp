#include "libperception/capture/ros/RosList.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <memory>
#include <thread>

#include "libperception/capture/ros/RosIntake.h"
#include "libperception/dds/RosGraph.h"
#include "libperception/importers/bags/BagContents.h"

namespace perception {
namespace {

struct Listened {
  GraphTopic found;
  std::unique_ptr<RawReader> reader;
  std::chrono::steady_clock::time_point since;
};

std::string lineOf(const std::string& name, const Listened& topic, double seconds) {
  const RawReader::Ledger ledger = topic.reader->ledger();
  const std::string use = useOfTopic(liveTopic(name, topic.found.type));
  return fmt::format("{:<36} {:<34} {:>7}  {:<11} {:>8} {:>8.2f}  {}{}\n", name, topic.found.type,
                     topic.found.writers, topic.found.quality.reliable ? "reliable" : "best effort",
                     ledger.received,
                     seconds > 0 ? static_cast<double>(ledger.received) / seconds : 0,
                     use.empty() ? "not" : use, topic.found.quality.latched ? " (latched)" : "");
}

}  // namespace

std::string listOfGraph(const NetworkName& network, double seconds,
                        const std::function<bool()>& stop) {
  using Clock = std::chrono::steady_clock;
  const auto joined = Network::join(network);
  RosGraph graph(joined);
  std::map<std::string, Listened> topics;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end && !stop()) {
    for (const auto& [name, found] : graph.look()) {
      Listened& topic = topics[name];
      topic.found = found;
      if (topic.reader) continue;
      // One that asks for little is served by all; nothing that it gets is kept.
      const TopicQuality asked{found.quality.latched, found.quality.latched};
      topic.reader =
          std::make_unique<RawReader>(joined, wireTopicOf(name), wireTypeOf(found.type), asked, 1);
      topic.since = Clock::now();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::string text = fmt::format("{:<36} {:<34} {:>7}  {:<11} {:>8} {:>8}  {}\n", "topic", "type",
                                 "writers", "offered", "messages", "Hz", "read as");
  for (const auto& [name, topic] : topics)
    text += lineOf(name, topic, std::chrono::duration<double>(Clock::now() - topic.since).count());
  if (topics.empty())
    text +=
        fmt::format("no topic is written on {}, domain {}\n", network.interface, network.domain);
  return text;
}

}  // namespace perception
