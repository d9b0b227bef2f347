#include "train/data/open_source.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <system_error>

#include "runtime/error.h"
#include "train/data/load_scenes.h"
#include "train/data/read_ahead.h"
#include "train/rooms/room_source.h"

namespace vkopple {
namespace {

constexpr std::string_view kRooms = "rooms:";

std::unique_ptr<TripletSource> part_of(std::unique_ptr<TripletSource> source, BatchPart part) {
  if (part.count == 1) return source;
  return std::make_unique<PartSource>(std::move(source), part);
}

}  // namespace

bool names_rooms(const std::string& data) { return data.starts_with(kRooms); }

std::optional<uint64_t> rooms_seed(const std::string& data) {
  if (!names_rooms(data)) return std::nullopt;
  const std::string_view text = std::string_view(data).substr(kRooms.size());
  uint64_t seed = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (problem == std::errc() && end == text.data() + text.size()) return seed;
  throw UsageError(fmt::format("rooms:{}: the seed must be a whole number from 0 to {}", text, UINT64_MAX));
}

std::unique_ptr<TripletSource> open_triplets(const Device& device, const std::string& data, const Lens& lens,
                                             const RoomsConfig& rooms, int batch,
                                             const SourceOptions& options) {
  if (const auto rooms_of = rooms_seed(data))
    return part_of(std::make_unique<RoomSource>(device, lens, rooms, batch, *rooms_of), options.part);
  const LoadLimits limits{.scenes = options.reading == Reading::kEvaluation ? options.scenes : UINT64_MAX};
  auto source =
      part_of(std::make_unique<ShardSource>(load_scenes(data, lens, limits), data, lens, batch, options.seed,
                                            options.reading, options.part.count * options.portions),
              options.part);
  if (options.reading == Reading::kTraining)
    return std::make_unique<ReadAhead>(std::move(source), options.threads);
  return source;
}

}  // namespace vkopple
