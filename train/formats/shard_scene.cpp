#include "train/formats/shard_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "runtime/error.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

using nlohmann::ordered_json;

template <std::size_t N>
std::array<double, N> coordinates(const JsonView& view) {
  const std::vector<double> values = view.numbers(N);
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) {
    if (std::abs(values[i]) > kFarthest) view.fail(fmt::format("numbers up to {}", kFarthest));
    result[i] = values[i];
  }
  return result;
}

Json parse(const Sample& sample) {
  const std::vector<std::byte>& bytes = sample.part("json");
  return parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, sample.where("json"));
}

std::array<double, 3> transformed(const Matrix4& m, const std::array<double, 3>& p) {
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
  return out;
}

std::array<double, 3> seen_by(const CameraPose& camera, const std::array<double, 3>& point) {
  return transformed(relative(CameraPose{}, camera), point);
}

ordered_json frame_json(const SceneFrame& frame) {
  ordered_json json = ordered_json::object();
  if (frame.camera) json["camera"] = *frame.camera;
  if (!frame.objects) return json;
  std::vector<uint64_t> pixels(frame.objects->size());
  for (const uint32_t id : frame.ids.pixels)
    if (id > 0) ++pixels.at(id - 1);
  ordered_json objects = ordered_json::array();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PlacedObject& object = (*frame.objects)[i];
    ordered_json entry{{"location", object.location}};
    if (frame.camera) entry["location_in_camera"] = seen_by(*frame.camera, object.location);
    if (object.yaw) entry["yaw"] = *object.yaw;
    if (!frame.ids.pixels.empty()) entry["pixels"] = pixels[i];
    objects.push_back(entry);
  }
  json["objects"] = objects;
  return json;
}

}  // namespace

ShardScene::ShardScene(const Sample& sample)
    : sample_(sample), json_(parse(sample)), view_(json_, sample.where("json")) {}

RgbImage ShardScene::image(int frame) const {
  const std::string name = fmt::format("{}.png", frame);
  return decode_png(sample_.part(name), sample_.where(name));
}

bool ShardScene::has_layers(int frame) const { return sample_.parts.contains(fmt::format("{}.exr", frame)); }

DepthAndIds ShardScene::layers(int frame) const {
  const std::string name = fmt::format("{}.exr", frame);
  DepthAndIds stored = decode_exr(sample_.part(name), sample_.where(name));
  if (!is_sound(stored.depth))
    throw Error(fmt::format("{}: Z is negative, not a number or over {}; generate it again",
                            sample_.where(name), kFarthest));
  const auto most = std::max_element(stored.ids.pixels.begin(), stored.ids.pixels.end());
  if (most != stored.ids.pixels.end() && *most > kMostSceneObjects)
    throw Error(
        fmt::format("{}: objectId is {}; at most {} are read", sample_.where(name), *most, kMostSceneObjects));
  return stored;
}

std::optional<CameraPose> ShardScene::camera(int frame) const {
  const JsonView view = frame_view(frame);
  if (!view.contains("camera")) return std::nullopt;
  return coordinates<6>(view["camera"]);
}

std::vector<std::array<double, 3>> ShardScene::locations_in_camera(int frame) const {
  const JsonView listed = frame_view(frame)["objects"];
  std::vector<std::array<double, 3>> all;
  for (std::size_t i = 0; i < listed.size(); ++i)
    all.push_back(coordinates<3>(listed[i]["location_in_camera"]));
  return all;
}

std::vector<std::optional<double>> ShardScene::yaws_in_camera(int frame) const {
  const JsonView listed = frame_view(frame)["objects"];
  const auto seen_from = camera(frame);
  std::vector<std::optional<double>> all(listed.size());
  for (std::size_t i = 0; i < listed.size(); ++i)
    if (seen_from && listed[i].contains("yaw")) all[i] = listed[i]["yaw"].number() - (*seen_from)[3];
  return all;
}

std::vector<PlacedObject> ShardScene::objects(int frame) const {
  const JsonView listed = frame_view(frame)["objects"];
  std::vector<PlacedObject> all;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    PlacedObject object{coordinates<3>(listed[i]["location"]), std::nullopt};
    if (listed[i].contains("yaw")) object.yaw = listed[i]["yaw"].number();
    all.push_back(object);
  }
  return all;
}

SceneData ShardScene::whole() const {
  SceneData scene{.key = sample_.key, .source = sample_.where("json"), .fov = fov()};
  if (view_.contains("scale")) scene.scale = view_["scale"].number();
  int frames = 0;
  while (sample_.parts.contains(fmt::format("{}.png", frames))) ++frames;
  for (int i = 0; i < frames; ++i) {
    SceneFrame frame{.image = image(i), .camera = camera(i)};
    if (has_layers(i)) {
      DepthAndIds known = layers(i);
      frame.depth = std::move(known.depth);
      frame.ids = std::move(known.ids);
    }
    check_film_size(static_cast<std::size_t>(frames), frame, sample_.where(fmt::format("{}.png", i)));
    if (has_objects(i)) frame.objects = objects(i);
    scene.frames.push_back(std::move(frame));
  }
  if (!view_.contains("objects")) return scene;
  const JsonView listed = view_["objects"];
  for (std::size_t i = 0; i < listed.size(); ++i)
    scene.shapes.push_back(listed[i].contains("shape") ? listed[i]["shape"].string() : "");
  return scene;
}

JsonView ShardScene::frame_view(int frame) const {
  const JsonView frames = view_["frames"];
  if (frames.size() <= static_cast<std::size_t>(frame))
    frames.fail(fmt::format("a list of more than {} frames", frame));
  return frames[static_cast<std::size_t>(frame)];
}

Sample shard_sample(const SceneData& scene) {
  Sample sample;
  sample.key = scene.key;
  ordered_json json{{"fov", scene.fov}};
  if (scene.scale != 1) json["scale"] = scene.scale;
  for (const std::string& shape : scene.shapes) json["objects"].push_back({{"shape", shape}});
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const SceneFrame& frame = scene.frames[i];
    sample.parts[fmt::format("{}.png", i)] = encode_png(frame.image);
    if (!frame.depth.pixels.empty() || !frame.ids.pixels.empty())
      sample.parts[fmt::format("{}.exr", i)] = encode_exr({frame.depth, frame.ids});
    json["frames"].push_back(frame_json(frame));
  }
  const std::string text = json.dump(1) + "\n";
  const auto bytes = std::as_bytes(std::span(text));
  sample.parts["json"] = {bytes.begin(), bytes.end()};
  return sample;
}

}  // namespace vkopple
