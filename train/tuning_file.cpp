#include "train/tuning_file.h"

#include <fmt/format.h>

#include "graph/conv/conv_tuning.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/warn.h"
#include "train/json_io.h"

namespace vkopple {
namespace {

constexpr int64_t kFormat = 1;
constexpr size_t kLargestFile = size_t{16} << 20;
constexpr size_t kMostNumbers = 8;

/// Whose choices they are.
Json owner(const Caps& caps) {
  return {{"device", uuid_text(caps.uuid)},
          {"driver", uuid_text(caps.driver_uuid)},
          {"driver_version", caps.driver_version}};
}

std::vector<uint32_t> numbers(const JsonView& list) {
  if (list.size() > kMostNumbers) list.fail("a few numbers");
  std::vector<uint32_t> values;
  for (size_t i = 0; i < list.size(); ++i)
    values.push_back(static_cast<uint32_t>(list[i].integer(0, 0xFFFFFFFF)));
  return values;
}

TunedChoices read(const std::filesystem::path& file, const Caps& caps) {
  const Json json = read_json(file, kLargestFile);
  const JsonView root(json, file.string());
  if (root["format"].integer(0, 1'000'000) != kFormat) root["format"].fail("1");
  if (root["made_for"].json() != owner(caps))
    throw Error(file.string() + ": made for another device or driver");
  const JsonView choices = root["choices"];
  if (!choices.json().is_object()) choices.fail("an object");
  TunedChoices known;
  for (const auto& [key, value] : choices.json().items()) {
    try {
      auto tile = numbers(choices[key]);
      if (!is_tuned_choice(key, tile, caps)) throw Error(choices[key].where() + " is no tile of this device");
      known.emplace(key, std::move(tile));
    } catch (const Error& error) {
      warn(fmt::format("{}; this choice is ignored", error.what()));
    }
  }
  return known;
}

}  // namespace

std::filesystem::path tuning_file(const Caps& caps) {
  const auto folder = default_cache_folder();
  if (folder.empty()) return {};
  return folder / fmt::format("tuning-{}-{:x}.json", uuid_text(caps.uuid), caps.driver_version);
}

std::shared_ptr<const TunedChoices> read_tuned_choices(const std::filesystem::path& file, const Caps& caps) {
  std::error_code error;
  if (file.empty() || !std::filesystem::exists(file, error)) return nullptr;
  try {
    auto choices = std::make_shared<const TunedChoices>(read(file, caps));
    return choices->empty() ? nullptr : choices;
  } catch (const Error& why) {
    warn(fmt::format("{}; its tuned choices are ignored, `vkopple tune` makes new ones", why.what()));
    return nullptr;
  }
}

std::shared_ptr<const TunedChoices> load_tuned_choices(const Caps& caps) {
  return read_tuned_choices(tuning_file(caps), caps);
}

void save_tuned_choices(const std::filesystem::path& file, const Caps& caps, const TunedChoices& choices) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);  // the write tells what is wrong
  write_json(file, {{"format", kFormat}, {"made_for", owner(caps)}, {"choices", choices}});
}

}  // namespace vkopple
