#include "train/exchange/torch_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/archive_writer.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;
using testing::ElementsAre;

constexpr size_t kLargest = size_t{1} << 20;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// A state dict of one tensor "t": what torch.save would write, but for what the arguments say.
std::string state_dict(const std::string& storage = "FloatStorage", const std::string& count = "K\x06",
                       const std::string& geometry = "I0\nK\x02K\x03\x86K\x03K\x01\x86") {
  return "\x80\x02}U\x01tctorch._utils\n_rebuild_tensor_v2\n((U\x07storagectorch\n" + storage +
         "\nU\x01"
         "0U\x03"
         "cpu" +
         count + "tQ" + geometry + "\x89}tRs.";
}

class TorchFileTest : public testing::Test {
 protected:
  std::filesystem::path path() const { return folder_ / "model.pt"; }

  void write(const std::string& pickle, size_t storage_bytes = 24, const std::string& order = "little") const {
    ArchiveWriter zip(path(), ArchiveKind::kStoredZip);
    zip.add("m/data.pkl", bytes_of(pickle));
    zip.add("m/byteorder", bytes_of(order));
    zip.add("m/data/0", std::vector<std::byte>(storage_bytes));
    zip.commit();
  }
  void expect_refused(std::initializer_list<std::string> parts) const {
    expect_error([&] { TorchFile file(path()); }, parts);
  }

  TempFolder folder_;
};

TEST_F(TorchFileTest, ReadsWhatPyTorchWrote) {
  const TorchFile file(std::filesystem::path(VKOPPLE_SOURCE_DIR) / "tests/fixtures/state_dict.pt");
  const auto doubles = [&](const std::string& name) { return to_doubles(file.read(name)); };
  EXPECT_THAT(file.names(), ElementsAre("bfloat16", "bool", "column", "empty", "float16", "float32", "float64",
                                        "int32", "int64", "part", "transposed", "uint8"));
  EXPECT_TRUE(file.metadata().empty());
  std::vector<double> counts;
  for (int i = 0; i < 24; ++i) counts.push_back(i);
  EXPECT_EQ(doubles("float32"), counts);
  EXPECT_EQ(file.shape("float32"), (StoredShape{2, 3, 4}));
  EXPECT_THAT(doubles("float64"), ElementsAre(0.1, -1e300));
  EXPECT_THAT(doubles("float16"), ElementsAre(1.5, -65504));
  EXPECT_THAT(doubles("bfloat16"), ElementsAre(1, -3));
  EXPECT_THAT(doubles("int64"), ElementsAre(1099511627776.0));
  EXPECT_EQ(file.shape("int64"), StoredShape{});
  EXPECT_EQ(file.read("int64").dtype, StoredType::kI64);
  EXPECT_THAT(doubles("int32"), ElementsAre(-7));
  EXPECT_THAT(doubles("uint8"), ElementsAre(200));
  EXPECT_THAT(doubles("bool"), ElementsAre(1, 0));
  EXPECT_EQ(file.shape("transposed"), (StoredShape{4, 2, 3}));
  EXPECT_THAT(doubles("transposed"), ElementsAre(0, 4, 8, 12, 16, 20, 1, 5, 9, 13, 17, 21, 2, 6, 10, 14, 18, 22,
                                                 3, 7, 11, 15, 19, 23));
  EXPECT_THAT(doubles("column"), ElementsAre(1, 5, 9, 13, 17, 21));
  EXPECT_THAT(doubles("part"), ElementsAre(16, 17, 18, 19, 20, 21, 22, 23));
  EXPECT_EQ(file.shape("empty"), (StoredShape{0, 3}));
  EXPECT_TRUE(file.read("empty").bytes.empty());
  expect_error([&] { (void)file.read("none"); }, {"state_dict.pt", "'none'"});
}

TEST_F(TorchFileTest, ReadsWhatItWrote) {
  const std::vector<float> floats{1, -2.5F, 3, 4, 5, 6};
  const std::vector<std::int64_t> ints{-9};
  const std::map<std::string, StoredTensor> tensors{{"a.weight", StoredTensor::of({2, 3}, floats)},
                                                    {"b", StoredTensor::of({}, ints)},
                                                    {"c", {StoredType::kBF16, {0, 2}, {}}}};
  write_torch(path(), {{"config", "{\"a\": 1}"}}, tensors);
  const auto bytes = read_file(path(), kLargest);
  const TorchFile file(path());
  ASSERT_EQ(file.names().size(), tensors.size());
  for (const auto& [name, tensor] : tensors) {
    EXPECT_EQ(file.shape(name), tensor.shape);
    EXPECT_EQ(file.read(name).dtype, tensor.dtype);
    EXPECT_EQ(file.read(name).bytes, tensor.bytes);
  }
  EXPECT_EQ(file.metadata().at("config"), "{\"a\": 1}");
  write_torch(path(), {{"config", "{\"a\": 1}"}}, tensors);
  EXPECT_EQ(read_file(path(), kLargest), bytes);
  expect_error(
      [&] {
        write_torch(path(), {}, {{"u", {StoredType::kU32, {1}, std::vector<std::byte>(4)}}});
      },
      {"model.pt", "'u'", "U32"});
}

TEST_F(TorchFileTest, HoldsTensorsAgainstTheirStorage) {
  write(state_dict());
  EXPECT_EQ(TorchFile(path()).shape("t"), (StoredShape{2, 3}));
  const auto geometry = [&](const std::string& numbers) {
    write(state_dict("FloatStorage", "K\x06", numbers));
  };
  const auto text = [](const char* digits) { return "I" + std::string(digits) + "\n"; };
  geometry(text("1") + "K\x02K\x03\x86K\x03K\x01\x86");
  expect_refused({"model.pt", "'t'", "beyond its storage", "offset 1"});
  geometry(text("0") + "K\x02K\x03\x86K\x04K\x01\x86");
  expect_refused({"beyond its storage", "strides [4, 1]"});
  geometry(text("0") + "K\x02K\x03\x86" + text("9223372036854775807") + "K\x01\x86");
  expect_refused({"beyond its storage"});
  geometry(text("0") + "K\x07\x85" + text("0") + "\x85");
  expect_refused({"more elements than its storage", ".contiguous()"});
  geometry(text("0") + "K\x02K\x03\x86K\x01\x85");
  expect_refused({"not as many strides"});
  geometry(text("-1") + "K\x02\x85K\x01\x85");
  expect_refused({"'t': offset", "from 0"});
  geometry(text("0") + "K\x02\x85" + text("-1") + "\x85");
  expect_refused({"'t': strides", "from 0"});
  std::string ones;
  for (int i = 0; i < 17; ++i) ones += "K\x01";
  geometry(text("0") + "(" + ones + "tK\x01\x85");
  expect_refused({"'t': shape", "more than 16"});
  write(state_dict(), 23);
  expect_refused({"'t': storage", "6 elements in 23 bytes"});
  write(state_dict("FloatStorage", "K\x07"));
  expect_refused({"7 elements in 24 bytes"});
  write(state_dict("DoubleStorage"));
  expect_refused({"6 elements in 24 bytes"});
}

TEST_F(TorchFileTest, RefusesWhatIsNoStateDict) {
  write("cmodel\nOpple\n.");
  expect_refused({"model.pt: data.pkl: byte 0", "'model.Opple'", "refused"});
  write(
      "\x80\x02}U\x05"
      "epochK\x03s.");
  expect_refused({"'epoch' is a whole number, not a tensor", "state_dict()"});
  write("].");
  expect_refused({"a list instead of a dict of tensors"});
  write("}K\x01K\x02s.");
  expect_refused({"a tensor's name is a whole number"});
  write(state_dict("QInt8Storage"));
  expect_refused({"'torch.QInt8Storage'", "refused"});
  std::string elsewhere = state_dict();
  elsewhere.replace(elsewhere.find("U\x01"
                                   "0"),
                    3,
                    "U\x01"
                    "7");
  write(elsewhere);
  expect_refused({"'t': storage", "no member data/'7'"});
  write(state_dict(), 24, "big");
  expect_refused({"byte order", "'big'"});
}

TEST_F(TorchFileTest, RefusesOtherFiles) {
  write_file(path(), "\x80\x02\x8a\x0al\xfc\x9c\x46\xf9 what PyTorch wrote before 1.6");
  expect_refused({"model.pt", "no zip file", "torch.save"});
  ArchiveWriter zip(path(), ArchiveKind::kStoredZip);
  zip.add("m/version", bytes_of("3\n"));
  zip.commit();
  expect_refused({"model.pt", "no member FOLDER/data.pkl"});
  write_torch(path(), {}, {{"t", StoredTensor::of({1}, std::vector<float>{1})}});
  const auto bytes = read_file(path(), kLargest);
  for (const size_t size : {bytes.size() - 1, bytes.size() / 2, size_t{40}}) {
    SCOPED_TRACE(size);
    write_file(path(), std::span(bytes).first(size));
    expect_refused({"model.pt"});
  }
  expect_error([&] { TorchFile file(folder_ / "none.pt"); }, {"none.pt"});
}

}  // namespace
}  // namespace vkopple
