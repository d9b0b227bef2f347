#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "train/formats/tfrecord.h"

namespace vkopple {

namespace records {
class Feature;
}

/// The features of a tf.train.Example: names with lists of bytes, of floats or of integers. A SequenceExample
/// reads like one: the steps of a feature list follow one another in one list. Every access throws an Error
/// that names file, record and feature where the feature isn't there or isn't of that kind.
class Example {
 public:
  /// Throws Error where the record holds something else.
  explicit Example(const TfRecord& record);
  ~Example();
  Example(Example&&) noexcept;
  Example& operator=(Example&&) noexcept;

  /// "file: record 3", for messages.
  const std::string& where() const { return where_; }
  /// "file: record 3: frames", likewise.
  std::string where(const std::string& name) const;

  bool contains(const std::string& name) const;
  /// "bboxes (48 floats), frames (6 byte strings), ...", by name.
  std::string listed() const;

  // All refer to this object.
  std::vector<std::string_view> bytes(const std::string& name) const;
  std::span<const float> floats(const std::string& name) const;
  std::span<const std::int64_t> integers(const std::string& name) const;

  /// Of exactly `count` values.
  std::vector<std::string_view> bytes(const std::string& name, std::size_t count) const;
  std::span<const float> floats(const std::string& name, std::size_t count) const;

  /// All byte strings one after the other, `count` bytes in all: some files give an image as one string, others
  /// as a string for every byte.
  std::vector<std::uint8_t> joined(const std::string& name, std::size_t count) const;

 private:
  struct Message;

  const records::Feature& get(const std::string& name, int kind) const;
  void check_count(const std::string& name, std::size_t is, std::size_t wanted) const;
  [[noreturn]] void fail(const std::string& name, const std::string& reason) const;

  std::string where_;
  std::unique_ptr<Message> message_;
};

}  // namespace vkopple
