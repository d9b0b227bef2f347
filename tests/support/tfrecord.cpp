#include "tests/support/tfrecord.h"

#include <archive.h>
#include <archive_entry.h>

#include <memory>
#include <span>
#include <stdexcept>

#include "train/atomic_file.h"
#include "train/crc32c.h"

namespace vkopple::test {
namespace {

std::string little_endian(std::uint64_t value, std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 0xff);
  return text;
}

std::string check(const std::string& text) {
  return little_endian(masked_crc32c(std::as_bytes(std::span(text))), 4);
}

records::Feature& feature(records::Example& example, const std::string& name) {
  return (*example.mutable_features()->mutable_feature())[name];
}

}  // namespace

std::string framed(const std::string& record) {
  const std::string length = little_endian(record.size(), 8);
  return length + check(length) + record + check(record);
}

std::string gzipped(const std::string& bytes) {
  const auto release = [](archive* a) { archive_write_free(a); };
  const std::unique_ptr<archive, decltype(release)> writer(archive_write_new(), release);
  const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(),
                                                                            &archive_entry_free);
  std::string out(bytes.size() + 4096, '\0');
  std::size_t used = 0;
  archive_write_set_format_raw(writer.get());
  archive_write_add_filter_gzip(writer.get());
  archive_write_set_bytes_in_last_block(writer.get(), 1);
  archive_entry_set_pathname(entry.get(), "records");
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  if (archive_write_open_memory(writer.get(), out.data(), out.size(), &used) != ARCHIVE_OK ||
      archive_write_header(writer.get(), entry.get()) != ARCHIVE_OK ||
      archive_write_data(writer.get(), bytes.data(), bytes.size()) != static_cast<la_ssize_t>(bytes.size()) ||
      archive_write_close(writer.get()) != ARCHIVE_OK)
    throw std::runtime_error("can't compress");
  out.resize(used);
  return out;
}

void write_examples(const std::filesystem::path& path, const std::vector<records::Example>& examples,
                    bool gzip) {
  std::string all;
  for (const records::Example& example : examples) all += framed(example.SerializeAsString());
  write_file(path, gzip ? gzipped(all) : all);
}

void set_bytes(records::Example& example, const std::string& name, const std::vector<std::string>& values) {
  auto& list = *feature(example, name).mutable_bytes_list();
  list.clear_value();
  for (const std::string& value : values) list.add_value(value);
}

void set_floats(records::Example& example, const std::string& name, const std::vector<float>& values) {
  auto& list = *feature(example, name).mutable_float_list()->mutable_value();
  list.Assign(values.begin(), values.end());
}

void set_integers(records::Example& example, const std::string& name, const std::vector<std::int64_t>& values) {
  auto& list = *feature(example, name).mutable_int64_list()->mutable_value();
  list.Assign(values.begin(), values.end());
}

}  // namespace vkopple::test
