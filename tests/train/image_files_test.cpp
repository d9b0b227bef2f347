#include "train/image_files.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::TempFolder;

TEST(ImageFiles, OfAFolderInTheOrderOfTheirNumbers) {
  const TempFolder folder;
  for (const std::string name : {"frame10.png", "frame2.PNG", "frame1.jpg", "film.gif", ".hidden.png",
                                 "scene.json", "notes", "png", "trailing."})
    write_file(folder / name, "");
  std::filesystem::create_directory(folder / "folder.png");
  std::vector<std::string> names;
  for (const auto& file : image_files(folder.path())) names.push_back(file.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"film.gif", "frame1.jpg", "frame2.PNG", "frame10.png"}));
}

TEST(ImageFiles, OfAFile) {
  // Whatever it is called and whether it is there: reading it tells.
  EXPECT_EQ(image_files("absent.txt"), (std::vector<std::filesystem::path>{"absent.txt"}));
}

TEST(ImageFiles, AFolderWithoutAny) {
  const TempFolder folder;
  write_file(folder / "scene.json", "");
  test::expect_error([&] { image_files(folder.path()); }, {"no pictures", folder.path().string()});
}

}  // namespace
}  // namespace vkopple
