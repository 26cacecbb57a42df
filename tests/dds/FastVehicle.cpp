// A vehicle of another make: a process that writes and reads a ROS 2 graph by Fast DDS, and has
// nothing of Cyclone DDS.
//   play FILE.mcap DOMAIN [--speed FACTOR] [--best-effort] [--everywhere] [--wait READERS] [--times
//   N]
//                               writes the messages of a recording at their own pace; latched ones
//                               are there for who comes late
//   listen DOMAIN SECONDS TOPIC TYPE...   writes a line for each message: topic, bytes, first bytes
//   in hexadecimal
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fmt/format.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "libperception/interop/bags/ReadingBag.h"

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

using Clock = std::chrono::steady_clock;

/// A type known by its name: its messages are bytes, whose first four say how they are encoded.
class Bytes final : public fast::TopicDataType {
 public:
  explicit Bytes(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 16'000'000;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* to) override {
    const auto& bytes = *static_cast<std::string*>(data);
    to->reserve(static_cast<std::uint32_t>(bytes.size()));
    std::memcpy(to->data, bytes.data(), bytes.size());
    to->length = static_cast<std::uint32_t>(bytes.size());
    to->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* from, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<char*>(from->data), from->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// "sensor_msgs/PointCloud2" as ROS 2 writes it on the wire.
std::string typeOnWire(const std::string& type) {
  const auto slash = type.find('/');
  return type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + "_";
}

class Member {
 public:
  /// `everywhere`: with the transports that a node of ROS 2 has if it is not told otherwise.
  explicit Member(unsigned domain, bool everywhere = false) {
    fast::DomainParticipantQos qos;
    if (!everywhere) {
      qos.transport().use_builtin_transports = false;
      auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
      udp->interfaceWhiteList = {"127.0.0.1"};
      udp->sendBufferSize = udp->receiveBufferSize = 8'000'000;
      qos.transport().user_transports = {udp};
    }
    qos.wire_protocol().builtin.discovery_config.leaseDuration = {3, 0};
    qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {1, 0};
    participant_ = fast::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
  }
  bool works() const { return participant_ != nullptr; }

  fast::Topic* topic(const std::string& name, const std::string& type) {
    fast::TypeSupport support(new Bytes(typeOnWire(type)));
    support.register_type(participant_);
    return participant_->create_topic("rt" + name, typeOnWire(type), fast::TOPIC_QOS_DEFAULT);
  }
  fast::DataWriter* writer(const std::string& name, const std::string& type, bool reliable) {
    if (publisher_ == nullptr)
      publisher_ = participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
    const bool latched = name == "/tf_static";
    fast::DataWriterQos qos;
    qos.reliability().kind =
        reliable || latched ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
    qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = latched ? 1 : 10;
    qos.durability().kind =
        latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    qos.publish_mode().kind = fast::ASYNCHRONOUS_PUBLISH_MODE;
    return publisher_->create_datawriter(topic(name, type), qos);
  }
  fast::DataReader* reader(const std::string& name, const std::string& type) {
    if (subscriber_ == nullptr)
      subscriber_ = participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
    fast::DataReaderQos qos;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.history().depth = 50;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    return subscriber_->create_datareader(topic(name, type), qos);
  }

 private:
  fast::DomainParticipant* participant_ = nullptr;
  fast::Publisher* publisher_ = nullptr;
  fast::Subscriber* subscriber_ = nullptr;
};

struct Recorded {
  std::string topic, type, bytes;
  perception::Stamp stamp;
};

std::vector<Recorded> recordingOf(const std::string& path) {
  std::vector<Recorded> all;
  const auto bag = perception::openBag(path);
  for (perception::BagMessage m; bag->next(m);)
    all.push_back({m.topic->name, m.topic->type, std::string(m.bytes), m.stamp});
  return all;
}

bool hasReader(const fast::DataWriter* writer) {
  fast::PublicationMatchedStatus matched;
  const_cast<fast::DataWriter*>(writer)->get_publication_matched_status(matched);
  return matched.current_count > 0;
}

int play(const std::vector<std::string>& words) {
  double speed = 1;
  bool reliable = true, everywhere = false;
  std::size_t wait = 0;
  int times = 1;
  for (std::size_t i = 2; i < words.size(); ++i) {
    if (words[i] == "--speed")
      speed = std::stod(words.at(++i));
    else if (words[i] == "--best-effort")
      reliable = false;
    if (words[i] == "--everywhere")
      everywhere = true;
    else if (words[i] == "--wait")
      wait = std::stoul(words.at(++i));
    else if (words[i] == "--times")
      times = std::stoi(words.at(++i));
  }
  auto recording = recordingOf(words.at(0));
  Member member(static_cast<unsigned>(std::stoul(words.at(1))), everywhere);
  if (!member.works() || recording.empty()) return 69;
  std::map<std::string, fast::DataWriter*> writers;
  for (const Recorded& m : recording)
    if (writers.count(m.topic) == 0) writers[m.topic] = member.writer(m.topic, m.type, reliable);
  // What is latched is there from the beginning.
  for (Recorded& m : recording)
    if (m.topic == "/tf_static") writers[m.topic]->write(&m.bytes);
  for (int i = 0; i < 600; ++i) {
    std::size_t read = 0;
    for (const auto& row : writers) read += hasReader(row.second);
    if (read >= wait) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  // A reader that wants no message again is told of us a moment after we are told of it.
  if (wait > 0) std::this_thread::sleep_for(std::chrono::milliseconds(500));
  fmt::print("playing\n");
  std::fflush(stdout);
  for (int k = 0; k < times; ++k) {
    const auto begin = Clock::now();
    for (Recorded& m : recording) {
      if (m.topic == "/tf_static") continue;
      const double due = (m.stamp - recording.front().stamp) / speed;
      std::this_thread::sleep_until(
          begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(due)));
      writers[m.topic]->write(&m.bytes);
    }
  }
  for (const auto& row : writers) row.second->wait_for_acknowledgments({5, 0});
  // Best effort acknowledges nothing, and the last messages are sent by a thread.
  if (!reliable) std::this_thread::sleep_for(std::chrono::milliseconds(500));
  fmt::print("played {} messages\n", recording.size());
  return 0;
}

int listen(const std::vector<std::string>& words) {
  Member member(static_cast<unsigned>(std::stoul(words.at(0))));
  if (!member.works()) return 69;
  std::map<std::string, fast::DataReader*> readers;
  for (std::size_t i = 2; i + 1 < words.size(); i += 2)
    readers[words[i]] = member.reader(words[i], words[i + 1]);
  const auto end = Clock::now() + std::chrono::duration<double>(std::stod(words.at(1)));
  while (Clock::now() < end) {
    for (const auto& [topic, reader] : readers) {
      std::string bytes;
      for (fast::SampleInfo info;
           reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK;) {
        if (!info.valid_data) continue;
        fmt::print("{} {} ", topic, bytes.size());
        for (const char byte : bytes) fmt::print("{:02x}", static_cast<unsigned char>(byte));
        fmt::print("\n");
        std::fflush(stdout);
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + (argc > 1 ? 2 : 1), argv + argc);
  try {
    if (argc > 3 && argv[1] == std::string("play")) return play(words);
    if (argc > 3 && argv[1] == std::string("listen")) return listen(words);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 65;
  }
  fmt::print(stderr, "play FILE DOMAIN ... | listen DOMAIN SECONDS TOPIC TYPE ...\n");
  return 64;
}
