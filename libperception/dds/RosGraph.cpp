#include "libperception/dds/RosGraph.h"

#include <dds/dds.h>
#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::string_view kTopics = "rt/", kMessages = "::msg::dds_::";
constexpr std::size_t kLookedAtOnce = 64;
/// Writers that are known at most: the rest of a graph that floods us is left alone.
constexpr std::size_t kMostWriters = 10'000;

TopicQuality qualityOf(const dds_qos_t* qos) {
  TopicQuality quality;
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_duration_t blocking = 0;
  if (qos != nullptr) {
    dds_qget_reliability(qos, &reliability, &blocking);
    dds_qget_durability(qos, &durability);
  }
  quality.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  quality.latched = durability != DDS_DURABILITY_VOLATILE;
  return quality;
}

}  // namespace

std::string wireTopicOf(const std::string& topic) {
  return "rt" + (topic.empty() || topic[0] != '/' ? "/" + topic : topic);
}

std::optional<std::string> rosTopicOf(const std::string& wire) {
  if (wire.rfind(kTopics, 0) != 0) return {};
  return wire.substr(kTopics.size() - 1);
}

std::string wireTypeOf(const std::string& type) {
  const auto slash = type.find('/');
  return type.substr(0, slash) + std::string(kMessages) + type.substr(slash + 1) + "_";
}

std::optional<std::string> rosTypeOf(const std::string& wire) {
  const auto at = wire.find(kMessages);
  if (at == std::string::npos || at == 0 || wire.back() != '_') return {};
  const auto name = at + kMessages.size();
  return wire.substr(0, at) + "/" + wire.substr(name, wire.size() - 1 - name);
}

RosGraph::RosGraph(std::shared_ptr<Network> network) : network_(std::move(network)) {
  reader_ = dds_create_reader(network_->participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr,
                              nullptr);
  if (reader_ < 0)
    throw Error(ExitCode::kUnavailable,
                fmt::format("DDS: topics of the graph: {}", dds_strretcode(-reader_)));
}

RosGraph::~RosGraph() { dds_delete(reader_); }

std::map<std::string, GraphTopic> RosGraph::look() {
  std::array<void*, kLookedAtOnce> samples{};
  std::array<dds_sample_info_t, kLookedAtOnce> infos{};
  for (int count = kLookedAtOnce; count == static_cast<int>(kLookedAtOnce);) {
    samples.fill(nullptr);
    count = dds_take(reader_, samples.data(), infos.data(), kLookedAtOnce, kLookedAtOnce);
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const std::uint64_t instance = infos[at].instance_handle;
      if (infos[at].instance_state != DDS_IST_ALIVE) {
        writers_.erase(instance);
        continue;
      }
      if (!infos[at].valid_data || writers_.size() >= kMostWriters) continue;
      const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[at]);
      const auto topic = rosTopicOf(endpoint.topic_name);
      const auto type = rosTypeOf(endpoint.type_name);
      if (topic && type) writers_[instance] = {*topic, *type, qualityOf(endpoint.qos)};
    }
    if (count > 0) dds_return_loan(reader_, samples.data(), count);
  }
  std::map<std::string, GraphTopic> topics;
  for (const auto& row : writers_) {
    const Writer& writer = row.second;
    GraphTopic& topic = topics[writer.topic];
    if (topic.writers == 0) {
      topic.type = writer.type;
      topic.quality = writer.quality;
    }
    if (topic.type != writer.type) {
      ++topic.others;
      continue;
    }
    ++topic.writers;
    topic.quality.reliable = topic.quality.reliable && writer.quality.reliable;
    topic.quality.latched = topic.quality.latched && writer.quality.latched;
  }
  return topics;
}

}  // namespace perception
