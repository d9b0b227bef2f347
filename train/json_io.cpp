#include "train/json_io.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/quote.h"

namespace vkopple {
namespace {

/// Walks the text and leaves in `*furthest` how far the parser has come: its callbacks are not told.
class TrackedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedIterator(const char* at, const char** furthest) : at_(at), furthest_(furthest) {}
  reference operator*() const { return *at_; }
  TrackedIterator& operator++() {
    *furthest_ = ++at_;
    return *this;
  }
  TrackedIterator operator++(int) {
    const TrackedIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const TrackedIterator& other) const { return at_ == other.at_; }
  bool operator!=(const TrackedIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** furthest_;
};

class StrictParser {
 public:
  StrictParser(std::string_view text, const std::string& source, const JsonLimits& limits)
      : text_(text), at_(text.data()), source_(source), limits_(limits) {}

  Json run() {
    const char* end = text_.data() + text_.size();
    const auto check = [this](int depth, Json::parse_event_t event, Json& value) {
      return on(depth, event, value);
    };
    try {
      return Json::parse(TrackedIterator(text_.data(), &at_), TrackedIterator(end, &at_), check);
    } catch (const Json::exception& problem) {
      fail(strip_prefix(problem.what()));
    }
  }

 private:
  bool on(int depth, Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (event == Event::object_end || event == Event::array_end) {
      if (event == Event::object_end) keys_.pop_back();
      return true;
    }
    if (++values_ > limits_.max_values) fail(fmt::format("more than {} values", limits_.max_values));
    if (static_cast<std::size_t>(depth) >= limits_.max_depth) {
      fail(fmt::format("nested deeper than {} levels", limits_.max_depth));
    }
    if (event == Event::object_start) keys_.emplace_back();
    if (event == Event::key) {
      const auto& key = value.get_ref<const std::string&>();
      if (!keys_.back().insert(key).second) fail(fmt::format("the key {} is given twice", quote(key)));
    }
    return true;
  }

  /// "[json.exception.parse_error.101] parse error at line 1, column 2: why" -> "why"; the position is ours.
  static std::string strip_prefix(std::string_view message) {
    if (const auto bracket = message.find("] "); bracket != std::string_view::npos)
      message.remove_prefix(bracket + 2);
    if (message.starts_with("parse error")) {
      if (const auto colon = message.find(": "); colon != std::string_view::npos)
        message.remove_prefix(colon + 2);
    }
    return one_line(message);
  }

  [[noreturn]] void fail(const std::string& reason) const {
    const std::size_t read = static_cast<std::size_t>(at_ - text_.data());
    const std::string_view before =
        text_.substr(0, read > 0 ? read - 1 : 0);  // without the last character read
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
    throw Error(fmt::format("{}: not usable JSON at line {}, column {}: {}", source_, line, column, reason));
  }

  std::string_view text_;
  const char* at_;
  const std::string& source_;
  const JsonLimits& limits_;
  std::size_t values_ = 0;
  std::vector<std::set<std::string>> keys_;  ///< of the objects that are open
};

}  // namespace

Json parse_json(std::string_view text, const std::string& source, const JsonLimits& limits) {
  return StrictParser(text, source, limits).run();
}

Json read_json(const std::filesystem::path& path, std::size_t max_bytes) {
  return parse_json(read_text_file(path, max_bytes), one_line(path.string(), 4096));
}

void write_json(const std::filesystem::path& path, const Json& value) {
  write_file(path, value.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

bool JsonView::contains(const std::string& key) const {
  if (!value_.is_object()) fail("an object");
  return value_.contains(key);
}

JsonView JsonView::child(std::string_view key) const {
  JsonView result(value_, where_ + (is_root_ ? ": " : key.starts_with('[') ? "" : ".") + std::string(key));
  result.is_root_ = false;
  return result;
}

JsonView JsonView::operator[](const std::string& key) const {
  JsonView place = child(one_line(key));
  if (!contains(key)) throw Error(place.where_ + " is missing");
  JsonView result(value_.at(key), std::move(place.where_));
  result.is_root_ = false;
  return result;
}

std::size_t JsonView::size() const {
  if (!value_.is_array()) fail("an array");
  return value_.size();
}

JsonView JsonView::operator[](std::size_t index) const {
  JsonView place = child(fmt::format("[{}]", index));
  if (index >= size()) throw Error(place.where_ + " is missing");
  JsonView result(value_.at(index), std::move(place.where_));
  result.is_root_ = false;
  return result;
}

bool JsonView::boolean() const {
  if (!value_.is_boolean()) fail("true or false");
  return value_.get<bool>();
}

std::int64_t JsonView::integer(std::int64_t lowest, std::int64_t highest) const {
  const std::string wanted = fmt::format("a whole number from {} to {}", lowest, highest);
  if (!value_.is_number_integer()) fail(wanted);
  if (value_.is_number_unsigned() && value_.get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX))
    fail(wanted);
  const auto number = value_.get<std::int64_t>();
  if (number < lowest || number > highest) fail(wanted);
  return number;
}

double JsonView::number() const {
  if (!value_.is_number() || !std::isfinite(value_.get<double>())) fail("a number");
  return value_.get<double>();
}

const std::string& JsonView::string() const {
  if (!value_.is_string()) fail("a string");
  return value_.get_ref<const std::string&>();
}

std::vector<double> JsonView::numbers(std::size_t count) const {
  if (!value_.is_array() || value_.size() != count) fail(fmt::format("an array of {} numbers", count));
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = (*this)[i].number();
  return result;
}

void JsonView::fail(const std::string& wanted) const {
  const bool large = value_.is_structured() && value_.size() > 8;
  const std::string found = large ? fmt::format("an {} of {}", value_.type_name(), value_.size())
                                  : one_line(value_.dump(-1, ' ', false, Json::error_handler_t::replace), 80);
  throw Error(fmt::format("{} must be {}, not {}", where_, wanted, found));
}

}  // namespace vkopple
