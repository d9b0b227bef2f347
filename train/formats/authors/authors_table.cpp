#include "train/formats/authors/authors_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/formats/authors/authors_units.h"
#include "train/pickle/numpy_array.h"
#include "train/pickle/pickle.h"
#include "train/pickle/pickle_writer.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFrames = 3;  // of a row
constexpr std::size_t kMaxBytes = std::size_t{2} << 30;
constexpr std::size_t kMaxColumns = 1000;  // each row looks through them
constexpr std::size_t kMaxTextBytes = 4096;
constexpr std::string_view kTextPrefix = "cam_pos_";

template <std::size_t N>
std::array<double, N> first(const std::vector<double>& numbers, std::size_t at = 0) {
  std::array<double, N> result{};
  std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(at), N, result.begin());
  return result;
}

std::string column(const char* name, std::size_t frame) { return fmt::format("{}{}", name, frame + 1); }

/// Objects of a list, or of an array, in which there are three.
std::size_t object_count(const PickleView& cell) {
  const bool listed = cell.value().is(PickleKind::kList) || cell.value().is(PickleKind::kTuple);
  return listed ? cell.size() : 3;
}

/// Rows may share what they refer to, so that a small file can ask for any number of objects.
void check_count(const PickleView& objects, std::size_t count) {
  if (count > kMostSceneObjects) objects.fail(fmt::format("at most {} objects", kMostSceneObjects));
}

std::vector<PlacedObject> read_objects(const PickleView& places, const PickleView& poses) {
  const std::size_t count = object_count(places);
  check_count(places, count);
  const std::vector<double> place = places.numbers({count, 3}), pose = poses.numbers({count, 3});
  std::vector<PlacedObject> objects;
  for (std::size_t i = 0; i < count; ++i)
    objects.push_back(own_object(first<3>(place, 3 * i), first<3>(pose, 3 * i)));
  return objects;
}

AuthorsRow read_row(const PickleView& table, std::size_t row) {
  AuthorsRow result;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    result.stems.push_back(table[column("frame", frame)][row].string());
    result.cameras.push_back(own_camera(first<6>(table[column("campos", frame)][row].numbers({6}))));
    if (table.contains(column("objpos", frame)))
      result.objects.push_back(
          read_objects(table[column("objpos", frame)][row], table[column("objpose", frame)][row]));
  }
  if (!result.objects.empty() && result.objects.size() != kFrames)
    table.fail("a table with objpos1, objpos2 and objpos3, or none of them");
  if (!table.contains("objdeet1")) return result;
  const PickleView details = table["objdeet1"][row];
  check_count(details, details.size());
  for (std::size_t i = 0; i < details.size(); ++i) result.shapes.push_back(details[i][0].string());
  return result;
}

/// Six numbers between spaces, commas or brackets.
AuthorsPose parse_pose(const std::string& text, const std::string& source) {
  AuthorsPose pose{};
  std::size_t found = 0;
  const auto separates = [](char c) {
    return std::string_view(" \t\r\n,;()[]").find(c) != std::string_view::npos;
  };
  for (const char *at = text.data(), *end = at + text.size(); at != end;) {
    if (separates(*at)) {
      ++at;
      continue;
    }
    double value = 0;
    const auto [after, problem] = std::from_chars(at, end, value);
    if (problem != std::errc() || found == pose.size()) {
      found = 0;
      break;
    }
    pose[found++] = value;
    at = after;
  }
  if (found == pose.size()) return pose;
  throw Error(fmt::format("{}: must hold six numbers, X Y Z yaw pitch roll", source));
}

template <std::size_t N>
void write_numbers(PickleWriter& out, const std::array<double, N>& values) {
  out.list([&] {
    for (const double value : values) out.number(value);
  });
}

}  // namespace

std::vector<AuthorsRow> read_authors_table(const fs::path& path) {
  const std::vector<std::byte> bytes = read_file(path, kMaxBytes);
  const Pickle pickle(bytes, path.string(), numpy_globals());
  const PickleView table = pickle.view();
  if (!table.value().is(PickleKind::kDict) || table.value().items().size() > 2 * kMaxColumns)
    table.fail(fmt::format("a dict of at most {} columns", kMaxColumns));
  std::vector<AuthorsRow> rows;
  const std::size_t count = table["frame1"].size();
  for (std::size_t row = 0; row < count; ++row) rows.push_back(read_row(table, row));
  return rows;
}

std::vector<AuthorsRow> read_authors_texts(const fs::path& folder, std::size_t frames) {
  std::vector<fs::path> texts;
  std::error_code failed;
  for (auto entry = fs::directory_iterator(folder, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(kTextPrefix) && entry->path().extension() == ".txt") texts.push_back(entry->path());
  }
  if (failed)
    throw Error(fmt::format("cannot read the folder {}: {}", quote(folder.string(), 4096), failed.message()));
  std::sort(texts.begin(), texts.end());
  std::vector<AuthorsRow> rows;
  for (std::size_t begin = 0; begin + frames <= texts.size(); begin += frames) {
    AuthorsRow row;
    for (std::size_t i = begin; i < begin + frames; ++i) {
      row.stems.push_back(texts[i].stem().string().substr(kTextPrefix.size()));
      row.cameras.push_back(own_camera(parse_pose(read_text_file(texts[i], kMaxTextBytes), texts[i].string())));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string authors_table_pickle(const std::vector<AuthorsRow>& rows) {
  const auto all = [&](const auto& has) { return std::all_of(rows.begin(), rows.end(), has); };
  const bool objects = all([](const AuthorsRow& row) { return row.objects.size() == kFrames; });
  const bool shapes = objects && all([](const AuthorsRow& row) { return !row.shapes.empty(); });
  PickleWriter pickle;
  const auto each_row = [&](const std::string& name, const auto& cell) {
    pickle.text(name);
    pickle.list([&] {
      for (const AuthorsRow& row : rows) cell(row);
    });
  };
  pickle.dict([&] {
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      each_row(column("frame", frame), [&](const AuthorsRow& row) { pickle.text(row.stems.at(frame)); });
      each_row(column("campos", frame),
               [&](const AuthorsRow& row) { write_numbers(pickle, authors_camera(row.cameras.at(frame))); });
      if (objects) {
        each_row(column("objpos", frame), [&](const AuthorsRow& row) {
          pickle.list([&] {
            for (const PlacedObject& object : row.objects[frame])
              write_numbers(pickle, authors_location(object));
          });
        });
        each_row(column("objpose", frame), [&](const AuthorsRow& row) {
          pickle.list([&] {
            for (const PlacedObject& object : row.objects[frame])
              write_numbers(pickle, authors_object_pose(object));
          });
        });
      }
      if (shapes)
        each_row(column("objdeet", frame), [&](const AuthorsRow& row) {
          pickle.list([&] {
            for (const std::string& shape : row.shapes)
              pickle.list([&] {
                pickle.text(shape);
                pickle.text("");
              });
          });
        });
    }
  });
  return pickle.finish();
}

}  // namespace vkopple
