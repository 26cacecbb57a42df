#include "gui-offscreen/html/RunParts.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "gui-offscreen/html/HtmlText.h"

namespace perception {
namespace {

using Json = nlohmann::json;

std::string textOfPart(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Length of the text as four bytes, low first, text, block: as a live scene.
std::string framed(const std::string& text, const std::string& block) {
  std::string bytes;
  bytes.reserve(4 + text.size() + block.size());
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(text.size() >> (8 * i) & 255);
  return bytes += text, bytes += block;
}

std::string element(const std::string& id, const std::string& text) {
  return "<script type=\"text/plain\" id=\"" + id + "\">" + text + "</script>\n";
}

}  // namespace

RunParts::RunParts(const RunOutline& run, const RunRecord& record, const std::string& output,
                   Options options)
    : record_(record),
      options_(std::move(options)),
      scenes_(run.stamps.size()),
      slice_{run.dir, run.first_stamp, run.class_names, {}},
      spool_(output, options_.prefix) {
  const auto scenes = static_cast<double>(std::max<std::size_t>(scenes_, 1));
  const double returns = static_cast<double>(options_.budget.points) / RunData::kBase64 /
                         RunData::kPointBytes * (1 - RunData::kCellShare);
  every_ = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(scenes * kLeastReturns / std::max(returns, 1.0))));
  const auto images =
      static_cast<double>(std::max<std::size_t>(options_.budget.images / RunData::kImageBytes, 1));
  every_image_ =
      every_ * static_cast<std::size_t>(std::ceil(scenes / static_cast<double>(every_) / images));
  const Json head = RunData(slice_, record).collected();
  for (const char* key : {"id", "log", "simulated", "config", "classes"})
    index_[key] = head.at(key);
  for (const char* key : {"times", "parts", "objects", "layers", "weather"})
    index_[key] = Json::array();
  index_["judged"] = options_.judged;
  for (const Stamp& stamp : run.stamps)
    index_["times"].push_back(std::round((stamp - run.first_stamp) * 1000) / 1000);
}

// The part's own budget of bytes is that of its scenes with sensor data.
void RunParts::begin(std::vector<Scene> scenes, const RunErrors& errors) {
  if (data_) finish();
  if (scenes.empty()) return;
  if (!options_.origin) options_.origin = scenes.front().ego.T_world_ego.translation();
  slice_.scenes = std::move(scenes);
  const std::size_t sensed = (scenes_ + every_ - 1) / every_;
  RunData::Budget budget;
  budget.points = options_.budget.points / sensed * slice_.scenes.size();
  budget.images = options_.budget.images - std::min(options_.budget.images, image_bytes_);
  budget.every_image = 1;
  data_.emplace(slice_, record_, budget, options_.origin);
  if (options_.judged) data_->setErrors(errors);
}

void RunParts::add(std::size_t index, SceneView view) {
  if (index % every_image_ != 0) view.image.reset();
  if (sensed(index)) {
    data_->add(index - parts_ * kScenes, view);
  } else {
    data_->addTruth(index - parts_ * kScenes, view);
  }
}

void RunParts::noteLayers(const Json& scene) {
  for (const char* layer : {"truth", "measurements", "radar", "corridor"}) {
    if (scene.contains(layer)) layers_.insert(layer);
  }
  if (scene.contains("image")) layers_.insert("images");
  if (!scene.contains("block")) return;
  if (scene["block"][1] > 0) layers_.insert("points");
  if (scene["block"][2] > 0) layers_.insert("grid");
}

// The text is packed while the next part is collected.
void RunParts::finish() {
  const Json& all = data_->collected();
  for (const Json& scene : all.at("scenes")) noteLayers(scene);
  for (const Json& object : all.at("objects")) {
    const auto [span, is_new] =
        spans_.try_emplace(object.at("id").get<std::uint64_t>(), parts_, parts_);
    span->second.second = parts_;
  }
  points_seen_ += data_->pointsSeen();
  points_kept_ += data_->pointsKept();
  for (const Json& image : data_->images())
    image_bytes_ += image.get_ref<const std::string&>().size();
  index_["parts"].push_back(parts_ * kScenes);
  auto whole = std::make_shared<std::string>(framed(
      textOfPart({{"scenes", all.at("scenes")}, {"objects", all.at("objects")}}), data_->bytes()));
  keepPacked();
  packed_ = Packed{options_.prefix + "-" + std::to_string(parts_),
                   std::async(std::launch::async, [whole] { return base64(gzipped(*whole)); }),
                   data_->images().empty() ? "" : data_->images().dump()};
  data_.reset();
  ++parts_;
}

void RunParts::keepPacked() {
  if (!packed_) return;
  spool_.write(element(packed_->name, packed_->text.get()));
  if (!packed_->images.empty()) spool_.write(element(packed_->name + "-images", packed_->images));
  packed_.reset();
}

void RunParts::addEvent(Json event) {
  events_.push_back(std::move(event));
  ++event_count_;
  if (events_.size() == kEvents) keepEvents();
}

void RunParts::keepEvents() {
  if (events_.empty()) return;
  const std::size_t number = (event_count_ - 1) / kEvents;
  spool_.write(element(options_.prefix + "-events-" + std::to_string(number),
                       base64(gzipped(textOfPart(events_)))));
  events_.clear();
}

void RunParts::write(const TextSink& sink) {
  if (data_) finish();
  keepPacked();
  keepEvents();
  for (const auto& [id, span] : spans_) index_["objects"].push_back({id, span.first, span.second});
  for (const std::string& layer : layers_) index_["layers"].push_back(layer);
  index_["eventCount"] = event_count_;
  index_["points"] = {{"seen", points_seen_}, {"kept", points_kept_}, {"every", every_}};
  sink(element(options_.prefix + "-data", base64(gzipped(textOfPart(index_)))));
  spool_.copyTo(sink);
}

}  // namespace perception
