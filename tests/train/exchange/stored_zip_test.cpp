#include "train/exchange/stored_zip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/unhex.h"
#include "train/archive_writer.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

/// What Python's zipfile makes of a/data.pkl, 20 zeros, deflated.
constexpr std::string_view kDeflated =
    "504b0304140000000800000021008d9bd50f05000000140000000a000000612f646174612e706b6c6360c00400504b0102140314"
    "0000000800000021008d9bd50f05000000140000000a0000000000000000000000800100000000612f646174612e706b6c504b05"
    "060000000001000100380000002d0000000000";

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

TEST(StoredZip, ReadsStoredMembersOnly) {
  const TempFolder folder;
  write_file(folder / "a.zip", test::unhex(kDeflated));
  expect_error([&] { read_stored_zip(folder / "a.zip"); }, {"a.zip", "'a/data.pkl'", "compressed", "stored"});
}

/// Of a member that says it has a gigabyte.
TEST(StoredZip, MembersAreNoLargerThanTheFile) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "a.zip";
  ArchiveWriter zip(path, ArchiveKind::kStoredZip);
  zip.add("m/a", std::vector<std::byte>(100, std::byte{7}));
  zip.commit();
  auto bytes = read_file(path, 1 << 20);
  const std::array<std::byte, 4> hundred{std::byte{100}};
  int sizes = 0;
  for (auto at = bytes.begin(); at != bytes.end();) {
    at = std::search(at, bytes.end(), hundred.begin(), hundred.end());
    if (at == bytes.end()) break;
    at[3] = std::byte{0x40};
    ++sizes;
  }
  EXPECT_EQ(sizes, 6) << "stored and own, before the member, behind it and in the directory";
  write_file(path, bytes);
  expect_error([&] { read_stored_zip(path); }, {"a.zip", "'m/a'", "longer than the rest of the file"});
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
