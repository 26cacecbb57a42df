#include "libperception/dds/ObservationTopic.h"

#include <dds/dds.h>
#include <mrpt/serialization/CSerializable.h>

#include <array>
#include <random>

#include <messages.h>  // of messages.idl
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

using Message = perception_msg_dds__Observation_;
constexpr char kTopic[] = "perception/observations";
constexpr std::size_t kAtOnce = 32;

}  // namespace

ObservationPublisher::ObservationPublisher(const NetworkName& name)
    : network_(Network::join(name)),
      writer_(network_->writer(perception_msg_dds__Observation__desc, kTopic)) {
  std::random_device random;  // tells one publisher from another, and is in no result
  id_ = (std::uint64_t{random()} << 32) | random();
}

bool ObservationPublisher::publish(const mrpt::obs::CObservation& observation) {
  mrpt::serialization::ObjectToOctetVector(&observation, bytes_);
  Message message{};
  message.sensor = const_cast<char*>(observation.sensorLabel.c_str());
  message.writer = id_;
  message.number = number_++;
  message.data._buffer = bytes_.data();
  message.data._length = message.data._maximum = static_cast<std::uint32_t>(bytes_.size());
  return dds_write(writer_, &message) == DDS_RETCODE_OK;
}

ObservationSubscriber::ObservationSubscriber(const NetworkName& name)
    : network_(Network::join(name)),
      reader_(network_->reader(perception_msg_dds__Observation__desc, kTopic)) {
  registerPerceptionClasses();
}

std::shared_ptr<mrpt::obs::CObservation> ObservationSubscriber::observationOf(const void* from) {
  const auto& message = *static_cast<const Message*>(from);
  ++ledger_.received;
  const auto [next, is_new] = next_.try_emplace(message.writer, message.number);
  if (message.number > next->second) ledger_.lost += message.number - next->second;
  next->second = message.number + 1;
  std::shared_ptr<mrpt::obs::CObservation> observation;
  try {
    const std::vector<std::uint8_t> bytes(message.data._buffer,
                                          message.data._buffer + message.data._length);
    mrpt::serialization::CSerializable::Ptr object;
    if (!bytes.empty()) mrpt::serialization::OctetVectorToObject(bytes, object);
    observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
  } catch (const std::exception&) {  // of another program, or a newer version of it
  }
  if (!observation) ++ledger_.damaged;
  return observation;
}

std::vector<std::shared_ptr<mrpt::obs::CObservation>> ObservationSubscriber::take() {
  std::vector<std::shared_ptr<mrpt::obs::CObservation>> out;
  std::array<void*, kAtOnce> messages{};
  std::array<dds_sample_info_t, kAtOnce> infos{};
  for (;;) {
    messages.fill(nullptr);  // the middleware's own memory
    const int count = dds_take(reader_, messages.data(), infos.data(), kAtOnce, kAtOnce);
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (!infos[at].valid_data) continue;
      if (auto observation = observationOf(messages[at])) out.push_back(std::move(observation));
    }
    if (count > 0) dds_return_loan(reader_, messages.data(), count);
    if (count < static_cast<int>(kAtOnce)) return out;
  }
}

}  // namespace perception
