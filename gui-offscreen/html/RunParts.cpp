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

RunParts::RunParts(const TrackedRun& run, const RunRecord& record, const RunErrors* errors,
                   const std::optional<Vector3>& origin, const RunData::Budget& budget)
    : run_(run), record_(record), errors_(errors), budget_(budget) {
  if (!run.scenes.empty()) origin_ = run.scenes.front().ego.T_world_ego.translation();
  if (origin) origin_ = *origin;
  const auto scenes = static_cast<double>(std::max<std::size_t>(run.scenes.size(), 1));
  const double returns = static_cast<double>(budget.points) / RunData::kBase64 /
                         RunData::kPointBytes * (1 - RunData::kCellShare);
  every_ = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(scenes * kLeastReturns / std::max(returns, 1.0))));
  const auto images =
      static_cast<double>(std::max<std::size_t>(budget.images / RunData::kImageBytes, 1));
  every_image_ =
      every_ * static_cast<std::size_t>(std::ceil(scenes / static_cast<double>(every_) / images));
  const Json head =
      RunData(TrackedRun{run.dir, run.first_stamp, run.class_names, {}}, record).collected();
  for (const char* key : {"id", "log", "simulated", "config", "classes"})
    index_[key] = head.at(key);
  for (const char* key : {"times", "parts", "objects", "layers", "events", "weather"})
    index_[key] = Json::array();
  index_["judged"] = errors != nullptr;
  for (const Scene& scene : run.scenes)
    index_["times"].push_back(std::round((scene.stamp - run.first_stamp) * 1000) / 1000);
  if (!run.scenes.empty()) begin(0);
}

// The part's own budget of bytes is that of its scenes with sensor data.
void RunParts::begin(std::size_t part) {
  part_ = part;
  const std::size_t from = part * kScenes, to = std::min(from + kScenes, run_.scenes.size());
  const auto at = [&](std::size_t k) {
    return run_.scenes.begin() + static_cast<std::ptrdiff_t>(k);
  };
  slice_ = {run_.dir, run_.first_stamp, run_.class_names, {at(from), at(to)}};
  const std::size_t sensed = (run_.scenes.size() + every_ - 1) / every_;
  RunData::Budget budget;
  budget.points = budget_.points / sensed * slice_.scenes.size();
  budget.images = budget_.images - std::min(budget_.images, image_bytes_);
  budget.every_image = 1;
  data_.emplace(slice_, record_, budget, origin_);
  if (errors_) {
    const auto first = errors_->begin() + static_cast<std::ptrdiff_t>(from);
    data_->setErrors({first, first + static_cast<std::ptrdiff_t>(slice_.scenes.size())});
  }
}

void RunParts::add(std::size_t index, SceneView view) {
  while (index >= (part_ + 1) * kScenes) {
    finish();
    begin(part_ + 1);
  }
  if (index % every_image_ != 0) view.image.reset();
  if (sensed(index)) {
    data_->add(index - part_ * kScenes, view);
  } else {
    data_->addTruth(index - part_ * kScenes, view);
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
        spans_.try_emplace(object.at("id").get<std::uint64_t>(), part_, part_);
    span->second.second = part_;
  }
  points_seen_ += data_->pointsSeen();
  points_kept_ += data_->pointsKept();
  for (const Json& image : data_->images())
    image_bytes_ += image.get_ref<const std::string&>().size();
  images_.push_back(data_->images().empty() ? "" : data_->images().dump());
  index_["parts"].push_back(part_ * kScenes);
  auto whole = std::make_shared<std::string>(framed(
      textOfPart({{"scenes", all.at("scenes")}, {"objects", all.at("objects")}}), data_->bytes()));
  if (packed_.valid()) texts_.push_back(packed_.get());
  packed_ = std::async(std::launch::async, [whole] { return base64(gzipped(*whole)); });
}

std::string RunParts::html(const std::string& prefix) {
  if (data_) {
    finish();
    while ((part_ + 1) * kScenes < run_.scenes.size()) {
      begin(part_ + 1);
      finish();
    }
    texts_.push_back(packed_.get());
    data_.reset();
  }
  for (const auto& [id, span] : spans_) index_["objects"].push_back({id, span.first, span.second});
  for (const std::string& layer : layers_) index_["layers"].push_back(layer);
  index_["points"] = {{"seen", points_seen_}, {"kept", points_kept_}, {"every", every_}};
  std::string out = element(prefix + "-data", base64(gzipped(textOfPart(index_))));
  for (std::size_t n = 0; n < texts_.size(); ++n) {
    const std::string name = prefix + "-" + std::to_string(n);
    out += element(name, texts_[n]);
    if (!images_[n].empty()) out += element(name + "-images", images_[n]);
  }
  return out;
}

}  // namespace perception
