#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/live/LiveFeed.h"

namespace perception {

/// Makes the messages of the live page and of Foxglove's protocol; on the server's thread.
///
/// To pages: texts {"hello": ...}, {"weather": ...}, {"event": ...}, {"end": ...}, and binary
/// scenes: u32 length, that many bytes of JSON {"n": number, "latency": s, "scene": ...,
/// "objects": ...} as RunData makes them, then the block of returns and cells.
class LiveComposer {
 public:
  LiveComposer(LiveServer& server, std::vector<std::string> class_names, const std::string& log,
               const std::string& config);

  void begin();
  void compose(const LiveBatch& batch);
  void end();

 private:
  void sendScene(const LiveBatch& batch);
  void sendRows(const LiveBatch& batch);
  void sendFoxglove(const LiveBatch& batch);
  void sendTransform(const Pose3& T, Stamp stamp, const std::string& parent,
                     const std::string& child);
  void sendState(const LiveBatch& batch);
  SceneView viewOf(const LiveBatch& batch) const;
  std::string greeting() const;
  /// The channel of the topic, advertised when it is new.
  std::uint32_t channel(const std::string& topic, const McapWriter::Schema& schema);
  /// Newest alone with a slot; without, all.
  void send(const std::string& topic, const McapWriter::Schema& schema, const std::string& slot,
            Stamp stamp, std::string payload);

  LiveServer& server_;
  const std::vector<std::string> class_names_;
  const std::string log_, config_;
  bool simulated_ = false;
  std::optional<Vector3> origin_;  ///< [m] world, of the page
  std::uint64_t scenes_ = 0;
  Stamp last_;
  std::map<std::string, std::shared_ptr<const SensorFrame>> frames_;  ///< newest by label
  LiveBatch::Cells cells_;
  std::map<std::string, std::uint32_t> channels_;  ///< by topic
};

}  // namespace perception
