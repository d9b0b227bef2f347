#include "tests/fuzz/fuzz.h"
#include "tests/support/temp_folder.h"
#include "train/archive_writer.h"
#include "train/exchange/torch_file.h"

namespace vkopple::fuzz {

/// The pickle of a .pt with two storages, 0 and 1; the zip round it is made here, for its checksums.
void torch(Input input) {
  static const test::TempFolder kFolder;
  constexpr std::size_t kStorageBytes = 96;
  const std::vector<std::byte> storage(kStorageBytes);
  ArchiveWriter zip(kFolder / "a.pt", ArchiveKind::kStoredZip);
  zip.add("a/data.pkl", input);
  zip.add("a/data/0", storage);
  zip.add("a/data/1", storage);
  zip.commit();
  const TorchFile file(kFolder / "a.pt");
  for (const std::string& name : file.names())
    require(file.read(name).bytes.size() <= kStorageBytes, "a tensor is no larger than its storage");
}

}  // namespace vkopple::fuzz
