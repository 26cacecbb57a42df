#pragma once
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/messages/BagPackets.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

using BagTopicParamsByName = std::map<std::string, BagTopicParams>;

/// "/camera/image_raw" as a sensor's label and as the label of a section: camera_image_raw.
std::string labelOfTopic(const std::string& topic);
/// The same; where a topic of the recording before it in the alphabet has the same label, with a
/// number behind it.
std::string labelOfTopic(const std::string& topic, const BagContents& contents);
/// The vehicle's frame by its name: that of the parameters, else a usual one. Empty: there is none.
std::string namedBaseFrameOf(const BagParams& params, const BagContents& contents);
/// The same, else the frame that moves, else that of the first poses.
std::string baseFrameOf(const BagParams& params, const BagContents& contents);
/// The topic whose messages are the frames: the first cloud topic, else the first radar, else the
/// first camera, else the first detector that is asked for. Empty: there is none.
std::string framesTopicOf(const BagTopicParamsByName& topics, const BagContents& contents);

/// Makes of the messages of sensors what a log holds, of recordings and of running systems. What is
/// needed beside a message (frames, clocks, cameras) is taken from the contents as they are then.
class BagMeasurements {
 public:
  struct Outputs {
    /// `first`: in the first frame of reference of its topic.
    std::function<void(const std::string& topic, bool first, SensorFrame&& frame)> frame;
    std::function<void(Stamp stamp, std::shared_ptr<mrpt::obs::CObservation> observation)>
        observation;  ///< of satellites, an inertial unit or the wheels
  };
  /// `contents` and `topics` outlive this.
  BagMeasurements(const BagContents& contents, const BagTopicParamsByName& topics, Outputs outputs);

  /// The vehicle's frame, and its pose on the vehicle.
  void setBase(const std::string& frame, const Pose3& T_ego_base);
  /// Whether messages of the topic are asked for: boxes where the INI names their topic, others
  /// where it does not say no.
  bool uses(const BagTopic& topic) const;
  /// Whether the place of the message's frame on the vehicle is known.
  bool isPlaced(const std::string& topic, const ros::Header& header) const;
  /// Throws std::runtime_error for a message that cannot be.
  void take(const BagMessage& message);
  /// The last scans of lidars in packets.
  void finish();
  /// Topics whose data were moved back to the vehicle.
  std::vector<std::string> notes() const;
  /// Damaged or missing packets, and frames without a place on the vehicle.
  std::vector<std::string> warnings() const;

 private:
  BagTopicParams paramsOf(const std::string& topic) const;
  void takeSensor(const BagMessage& message, const BagType& type, const BagTopicParams& params);
  void takeReading(const BagMessage& message, const BagType& type, const BagTopicParams& params);
  void takePackets(const BagMessage& message, const BagType& type, const BagTopicParams& params);
  void takeFrame(const std::string& topic, const ros::Header& header, const BagTopicParams& params,
                 SensorFrame&& frame);
  std::string metadataFor(const std::string& topic, const BagType& type) const;
  double shiftOf(const BagMessage& message) const;
  std::string otherFrame(const std::string& topic, const ros::Header& header) const;
  void setCamera(const std::string& topic, const ros::Header& header, SensorFrame& frame) const;
  std::optional<CameraModel> cameraFor(const std::string& topic, const std::string& frame) const;
  std::optional<Pose3> placeOf(const ros::Header& header, const BagTopicParams& params) const;
  Pose3 mounting(const ros::Header& header, const BagTopicParams& params);
  bool isOfWorld(const ros::Header& header, const BagTopicParams& params) const;
  void place(const std::string& topic, const ros::Header& header, const BagTopicParams& params,
             SensorFrame& frame);

  const BagContents& contents_;
  const BagTopicParamsByName& topics_;
  Outputs outputs_;
  std::string base_;
  Pose3 T_ego_base_ = Pose3::Identity();
  /// By topic and frame of reference, which are a sensor each.
  std::map<std::pair<std::string, std::string>, std::unique_ptr<BagPackets>> packets_;
  std::map<std::string, std::pair<std::string, bool>>
      moved_;  ///< by topic: the frame its data were moved from, whether the sensor has a place
  std::set<std::string> radars_;                ///< topics whose clouds are a radar's
  std::set<std::string> unplaced_;              ///< frames without a place on the vehicle
  std::map<std::string, std::string> foreign_;  ///< frames of readings that are not the vehicle's
};

}  // namespace perception
