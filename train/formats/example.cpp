#include "train/formats/example.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <map>
#include <utility>

#include "example.pb.h"
#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

using records::Feature;

std::size_t value_count(const Feature& feature) {
  switch (feature.kind_case()) {
    case Feature::kBytesList:
      return static_cast<std::size_t>(feature.bytes_list().value_size());
    case Feature::kFloatList:
      return static_cast<std::size_t>(feature.float_list().value_size());
    case Feature::kInt64List:
      return static_cast<std::size_t>(feature.int64_list().value_size());
    case Feature::KIND_NOT_SET:
      return 0;
  }
  return 0;
}

const char* kind_name(Feature::KindCase kind) {
  switch (kind) {
    case Feature::kBytesList:
      return "byte strings";
    case Feature::kFloatList:
      return "floats";
    case Feature::kInt64List:
      return "integers";
    case Feature::KIND_NOT_SET:
      return "values";
  }
  return "values";
}

}  // namespace

struct Example::Message {
  std::map<std::string, Feature> features;
};

Example::Example(const TfRecord& record) : where_(record.where()), message_(std::make_unique<Message>()) {
  // A plain Example is a SequenceExample with nothing but its context.
  records::SequenceExample parsed;
  if (record.bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      !parsed.ParseFromArray(record.bytes.data(), static_cast<int>(record.bytes.size())))
    throw Error(where_ +
                " holds no tf.train.Example; check that the data set is of the format that it is read as");
  std::map<std::string, Feature>& features = message_->features;
  for (auto& [name, feature] : *parsed.mutable_context()->mutable_feature())
    features.emplace(name, std::move(feature));
  for (const auto& [name, list] : parsed.feature_lists().feature_list()) {
    Feature& all = features[name];
    for (const Feature& step : list.feature()) {
      // Merging two kinds would drop what there was of the first.
      if (value_count(all) > 0 && value_count(step) > 0 && all.kind_case() != step.kind_case())
        fail(name, fmt::format("has both {} and {}", kind_name(all.kind_case()), kind_name(step.kind_case())));
      all.MergeFrom(step);
    }
  }
}

Example::~Example() = default;
Example::Example(Example&&) noexcept = default;
Example& Example::operator=(Example&&) noexcept = default;

std::string Example::where(const std::string& name) const {
  return fmt::format("{}: {}", where_, one_line(name));
}

bool Example::contains(const std::string& name) const { return message_->features.contains(name); }

std::string Example::listed() const {
  constexpr std::size_t kMostNames = 64;
  std::vector<std::string> names;
  for (const auto& [name, feature] : message_->features) {
    if (names.size() == kMostNames) {
      names.emplace_back("...");
      break;
    }
    names.push_back(
        fmt::format("{} ({} {})", one_line(name), value_count(feature), kind_name(feature.kind_case())));
  }
  return names.empty() ? "no features" : fmt::format("{}", fmt::join(names, ", "));
}

std::vector<std::string_view> Example::bytes(const std::string& name) const {
  const auto& values = get(name, Feature::kBytesList).bytes_list().value();
  return {values.begin(), values.end()};
}

std::span<const float> Example::floats(const std::string& name) const {
  const auto& values = get(name, Feature::kFloatList).float_list().value();
  return {values.data(), static_cast<std::size_t>(values.size())};
}

std::span<const std::int64_t> Example::integers(const std::string& name) const {
  const auto& values = get(name, Feature::kInt64List).int64_list().value();
  return {values.data(), static_cast<std::size_t>(values.size())};
}

std::vector<std::string_view> Example::bytes(const std::string& name, std::size_t count) const {
  auto values = bytes(name);
  check_count(name, values.size(), count);
  return values;
}

std::span<const float> Example::floats(const std::string& name, std::size_t count) const {
  const auto values = floats(name);
  check_count(name, values.size(), count);
  return values;
}

std::vector<std::uint8_t> Example::joined(const std::string& name, std::size_t count) const {
  std::vector<std::uint8_t> all;
  for (const std::string& value : get(name, Feature::kBytesList).bytes_list().value()) {
    if (value.size() > count - all.size()) fail(name, fmt::format("has more bytes than {}", count));
    all.insert(all.end(), value.begin(), value.end());
  }
  check_count(name, all.size(), count);
  return all;
}

const Feature& Example::get(const std::string& name, int kind) const {
  const auto found = message_->features.find(name);
  if (found == message_->features.end()) fail(name, "is missing");
  const Feature::KindCase is = found->second.kind_case(), wanted = static_cast<Feature::KindCase>(kind);
  if (is != wanted && is != Feature::KIND_NOT_SET)
    fail(name, fmt::format("holds {}, not {}", kind_name(is), kind_name(wanted)));
  return found->second;
}

void Example::check_count(const std::string& name, std::size_t is, std::size_t wanted) const {
  if (is != wanted) fail(name, fmt::format("has {} values, not {}", is, wanted));
}

void Example::fail(const std::string& name, const std::string& reason) const {
  throw Error(fmt::format("{} {}", where(name), reason));
}

}  // namespace vkopple
