#include "train/exchange/stored_zip.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/unhex.h"
#include "train/archive_writer.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

/// What Python's zipfile makes of a/data.pkl, 2000 zeros, deflated.
constexpr std::string_view kDeflated =
    "504b03041400000008000000210044f4c90211000000d00700000a000000612f646174612e706b6c63601805a360148c8251"
    "300a46c1500700504b010214031400000008000000210044f4c90211000000d00700000a0000000000000000000000800100"
    "000000612f646174612e706b6c504b0506000000000100010038000000390000000000";

TEST(StoredZip, ReadsWhatWasWritten) {
  const TempFolder folder;
  const std::vector<std::byte> large(300'000, std::byte{7});
  ArchiveWriter zip(folder / "a.zip", ArchiveKind::kStoredZip);
  zip.add("m/large", large);
  zip.add("m/empty", {});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.zip"));
  zip.commit();
  const auto members = read_stored_zip(folder / "a.zip");
  ASSERT_EQ(members.size(), 2U);
  EXPECT_EQ(members.at("m/large"), large);
  EXPECT_TRUE(members.at("m/empty").empty());
  EXPECT_TRUE(is_zip(folder / "a.zip"));
  write_file(folder / "b.zip", "PK");
  EXPECT_FALSE(is_zip(folder / "b.zip"));
}

TEST(StoredZip, RefusesWhatIsCompressed) {
  const TempFolder folder;
  write_file(folder / "a.zip", test::unhex(kDeflated));
  expect_error([&] { read_stored_zip(folder / "a.zip"); }, {"a.zip", "'a/data.pkl'", "compressed"});
}

TEST(StoredZip, RefusesDamage) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "a.zip";
  ArchiveWriter zip(path, ArchiveKind::kStoredZip);
  zip.add("m/a", std::vector<std::byte>(100, std::byte{7}));
  zip.commit();
  auto bytes = read_file(path, 1 << 20);
  const auto place = std::search_n(bytes.begin(), bytes.end(), 100, std::byte{7});
  ASSERT_NE(place, bytes.end());
  place[50] = std::byte{8};
  write_file(path, bytes);
  expect_error([&] { read_stored_zip(path); }, {"a.zip", "'m/a'", "CRC"});
  write_file(path, "PK\x03\x04 and no more");
  expect_error([&] { read_stored_zip(path); }, {"a.zip", "not a whole zip"});
}

}  // namespace
}  // namespace vkopple
