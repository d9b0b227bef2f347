#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "train/append_file.h"
#include "train/image.h"

namespace vkopple {

/// A file of events as TensorBoard reads them: TFRecords (train/formats/tfrecord.h), each a protobuf message of
/// event.proto. Every event is on its way to the disk when add() returns. Throws Error naming the file.
class EventFile {
 public:
  using Scalars = std::map<std::string, double>;

  /// A new file in `folder`, which exists, for a run that goes on after `step` steps: what older files of the
  /// folder tell of later steps is void. Its name comes behind theirs, wherever the clock stands.
  EventFile(const std::filesystem::path& folder, uint64_t step, FileSystem& files = system_files());

  void add(uint64_t step, const Scalars& scalars);
  void add(uint64_t step, const std::string& tag, const RgbImage& picture);

  const std::filesystem::path& path() const { return file_.path(); }

 private:
  void write(const std::string& message);

  AppendFile file_;
};

}  // namespace vkopple
