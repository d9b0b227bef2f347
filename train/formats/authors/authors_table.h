#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "train/formats/scene.h"

namespace vkopple {

/// A row of the authors' table: three frames, or more where the table was made from a folder of texts.
struct AuthorsRow {
  std::vector<std::string> stems;  ///< of the names of a frame's pictures
  std::vector<CameraPose> cameras;
  std::vector<std::vector<PlacedObject>> objects;  ///< of each frame; empty where unknown
  std::vector<std::string> shapes;                 ///< of each object; empty where unknown
};

/// data_map.pickle, as docs/data.md describes it. Nothing in it is executed or trusted.
std::vector<AuthorsRow> read_authors_table(const std::filesystem::path& path);

/// Rows of `frames` frames of a folder of cam_pos_STEM.txt with six numbers each, in the order of their names;
/// what is left at the end is dropped.
std::vector<AuthorsRow> read_authors_texts(const std::filesystem::path& folder, std::size_t frames);

/// A pickle of a dict of lists, with the columns that are known of all rows, which have three frames.
std::string authors_table_pickle(const std::vector<AuthorsRow>& rows);

}  // namespace vkopple
