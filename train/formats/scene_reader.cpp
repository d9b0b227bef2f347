#include "train/formats/scene_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

/// Lets only sound scenes through.
class CheckedReader : public SceneReader {
 public:
  explicit CheckedReader(std::unique_ptr<SceneReader> reader) : reader_(std::move(reader)) {}

  std::optional<SceneData> next() override {
    std::optional<SceneData> scene = reader_->next();
    if (!scene) return scene;
    check_scene(*scene);
    if (!keys_.insert(scene->key).second)
      throw Error(
          fmt::format("{}: another scene has the key {} already", one_line(scene->source, 4096), scene->key));
    return scene;
  }
  std::optional<std::uint64_t> count() const override { return reader_->count(); }

 private:
  std::unique_ptr<SceneReader> reader_;
  std::set<std::string> keys_;
};

template <class Range, class Name>
std::string listed(const Range& range, const Name& name) {
  std::vector<std::string> names;
  for (const auto& element : range) names.push_back(name(element));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string name_of(const NamedHelp& help) { return help.name; }

void require_known(const std::map<std::string, std::string>& given, const std::vector<NamedHelp>& known,
                   const std::string& option, const std::string& format) {
  for (const auto& [name, value] : given) {
    const bool found = std::any_of(known.begin(), known.end(), [&name = name](const NamedHelp& known_name) {
      return known_name.name == name;
    });
    if (!found)
      throw UsageError(fmt::format("{} {}={}: the format {} knows {}", option, one_line(name), one_line(value),
                                   format, listed(known, name_of)));
  }
}

}  // namespace

SceneFormat scene_format(const std::string& name) {
  const std::vector<SceneFormat> all = scene_formats();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.name == name; });
  if (found != all.end()) return *found;
  throw UsageError(fmt::format("{} is no format of data sets; there are {}", quote(name),
                               listed(all, [](const auto& f) { return f.name; })));
}

SceneFormat detect_format(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw Error(fmt::format("{}: no such file or folder", quote(path.string(), 4096)));
  const std::vector<SceneFormat> all = scene_formats();
  std::vector<SceneFormat> matching;
  std::copy_if(all.begin(), all.end(), std::back_inserter(matching),
               [&](const SceneFormat& f) { return f.recognises(path); });
  if (matching.size() == 1) return matching[0];
  const auto name = [](const auto& f) { return f.name; };
  if (matching.empty())
    throw UsageError(
        fmt::format("{}: no known format of data sets; name one of {} by --format, see docs/data.md",
                    quote(path.string(), 4096), listed(all, name)));
  throw UsageError(
      fmt::format("{}: could be {}; name one by --format", quote(path.string(), 4096), listed(matching, name)));
}

std::unique_ptr<SceneReader> open_scenes(const std::filesystem::path& path, const std::string& name,
                                         const FormatOptions& options) {
  const SceneFormat format = name.empty() ? detect_format(path) : scene_format(name);
  require_known(options.settings, format.settings, options.option, format.name);
  require_known(options.fields, format.fields, "--map", format.name);
  return std::make_unique<CheckedReader>(format.open(path, options));
}

std::unique_ptr<SceneWriter> create_scenes(const std::filesystem::path& path, const std::string& name,
                                           const FormatOptions& options) {
  const SceneFormat format = scene_format(name);
  if (format.create == nullptr) throw UsageError(fmt::format("the format {} can only be read", format.name));
  require_known(options.settings, format.write_settings, options.option, format.name);
  return format.create(path, options);
}

}  // namespace vkopple
