#pragma once

#include <event.pb.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "train/formats/tfrecord.h"

namespace vkopple::test {

/// Files of a folder that TensorBoard would read, sorted.
inline std::vector<std::filesystem::path> event_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().find("tfevents") != std::string::npos) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// What a file of events holds, its checksums compared.
inline std::vector<tensorboard::Event> read_events(const std::filesystem::path& file) {
  std::vector<tensorboard::Event> events;
  TfRecordReader reader({file});
  while (const auto record = reader.next()) {
    tensorboard::Event event;
    if (!event.ParseFromArray(record->bytes.data(), static_cast<int>(record->bytes.size())))
      throw std::runtime_error("no event in " + record->where());
    events.push_back(std::move(event));
  }
  return events;
}

}  // namespace vkopple::test
