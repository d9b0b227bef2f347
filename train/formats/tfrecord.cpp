#include "train/formats/tfrecord.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/crc32c.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLengthBytes = 8, kCheckBytes = 4, kHeadBytes = kLengthBytes + kCheckBytes;
constexpr std::size_t kReadBytes = std::size_t{1} << 16;
constexpr std::size_t kFirstPiece = std::size_t{1} << 20;

/// Little-endian, as everything in these files.
std::uint64_t number(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  return value;
}

template <std::size_t count>
std::array<std::byte, count> little_endian(std::uint64_t number) {
  std::array<std::byte, count> bytes{};
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>(number >> 8 * i & 0xff);
  return bytes;
}

/// Whether `check` (4 bytes) is that of `bytes`.
bool agrees(std::span<const std::byte> bytes, std::span<const std::byte> check) {
  return masked_crc32c(bytes) == number(check);
}

std::string record_name(const fs::path& file, std::uint64_t index) {
  return fmt::format("{}: record {}", one_line(file.string(), 4096), index);
}

struct Release {
  void operator()(archive* a) const { archive_read_free(a); }
};

/// The bytes of a file, decompressed where they are compressed.
class ByteStream {
 public:
  explicit ByteStream(const fs::path& path) : path_(path), file_(open_for_reading(path)) {
    std::array<std::byte, kHeadBytes> head{};
    const ssize_t got = ::pread(file_.get(), head.data(), head.size(), 0);
    if (got < 0) fail("can't be read", std::strerror(errno));
    if (got == 0) return;
    // A plain file is told by its first check: its length may begin like GZIP's mark.
    const bool whole = static_cast<std::size_t>(got) == head.size();
    if (whole && agrees(std::span(head).first(kLengthBytes), std::span(head).last(kCheckBytes))) return;
    if (head[0] != std::byte{0x1f} || head[1] != std::byte{0x8b})
      fail("is no TFRecord file, plain or of GZIP, or is damaged at its start",
           "check the path, or fetch it again");
    open_gzip();
  }

  /// How many of the bytes wanted there were left.
  std::size_t read(std::span<std::byte> to) {
    std::size_t used = 0;
    while (!empty_ && used < to.size()) {
      const auto got = gzip_ ? archive_read_data(gzip_.get(), to.data() + used, to.size() - used)
                             : ::read(file_.get(), to.data() + used, to.size() - used);
      if (got < 0) {
        const char* why = gzip_ ? archive_error_string(gzip_.get()) : std::strerror(errno);
        fail("can't be read on", why != nullptr ? why : "unknown reason");
      }
      if (got == 0) break;
      used += static_cast<std::size_t>(got);
    }
    return used;
  }

 private:
  void open_gzip() {
    gzip_.reset(archive_read_new());
    archive_read_support_filter_gzip(gzip_.get());
    archive_read_support_format_raw(gzip_.get());
    archive_read_support_format_empty(gzip_.get());
    archive_entry* entry = nullptr;
    const bool opened = archive_read_open_fd(gzip_.get(), file_.get(), kReadBytes) == ARCHIVE_OK;
    const int header = opened ? archive_read_next_header(gzip_.get(), &entry) : ARCHIVE_FATAL;
    empty_ = header == ARCHIVE_EOF;
    if ((header != ARCHIVE_OK && !empty_) || archive_filter_code(gzip_.get(), 0) != ARCHIVE_FILTER_GZIP)
      fail("has a damaged GZIP header", "fetch it again");
  }

  [[noreturn]] void fail(const std::string& what, const std::string& more) const {
    throw Error(fmt::format("{}: {}: {}", one_line(path_.string(), 4096), what, one_line(more)));
  }

  fs::path path_;
  FileDescriptor file_;
  bool empty_ = false;                      ///< nothing is compressed there, which the library does not read
  std::unique_ptr<archive, Release> gzip_;  ///< null for a plain file; after the descriptor that it reads
};

}  // namespace

std::string TfRecord::where() const { return record_name(file, index); }

std::vector<fs::path> find_tfrecords(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_directory(path, failed)) return {path};
  std::vector<fs::path> files;
  for (auto entry = fs::directory_iterator(path, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    if (entry->path().filename().string().find(".tfrecord") != std::string::npos)
      files.push_back(entry->path());
  }
  const std::string name = quote(path.string(), 4096);
  if (failed) throw Error(fmt::format("cannot read the folder {}: {}", name, failed.message()));
  if (files.empty())
    throw Error(fmt::format("no file with .tfrecord in its name lies in {}; name a file or its folder", name));
  std::sort(files.begin(), files.end());
  return files;
}

/// One file, read from its start.
class TfRecordReader::File {
 public:
  File(fs::path path, std::size_t most_bytes)
      : path_(std::move(path)), most_bytes_(most_bytes), stream_(path_) {}

  std::optional<TfRecord> next() {
    std::array<std::byte, kHeadBytes> head{};
    const std::size_t got = read(head);
    if (got == 0) return std::nullopt;
    if (got < head.size()) fail("it is cut off; fetch the file again");
    const auto length_bytes = std::span(head).first(kLengthBytes);
    if (!agrees(length_bytes, std::span(head).last(kCheckBytes)))
      fail("its length's checksum is wrong: the file is damaged; fetch it again");
    const std::uint64_t length = number(length_bytes);
    if (length > most_bytes_)
      fail(fmt::format("its {} bytes are more than the {} that are read", length, most_bytes_));
    TfRecord record{{}, path_, index_};
    read_piece_by_piece(record.bytes, length + kCheckBytes);
    if (!agrees(std::span(record.bytes).first(length), std::span(record.bytes).last(kCheckBytes)))
      fail("its checksum is wrong: the file is damaged; fetch it again");
    record.bytes.resize(length);
    ++index_;
    return record;
  }

 private:
  /// What a length announces takes no memory before it is there.
  void read_piece_by_piece(std::vector<std::byte>& to, std::size_t count) {
    while (to.size() < count) {
      const std::size_t before = to.size();
      to.resize(std::min(count, before + std::max(before, kFirstPiece)));
      if (read(std::span(to).subspan(before)) < to.size() - before) fail("it is cut off; fetch the file again");
    }
  }
  /// As ByteStream::read, whose errors know no record.
  std::size_t read(std::span<std::byte> to) {
    try {
      return stream_.read(to);
    } catch (const Error& error) {
      throw Error(fmt::format("{} (in record {})", error.what(), index_));
    }
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(fmt::format("{}: {}", record_name(path_, index_), reason));
  }

  fs::path path_;
  std::size_t most_bytes_;
  ByteStream stream_;
  std::uint64_t index_ = 0;
};

void write_tfrecord(std::ostream& to, std::span<const std::byte> record) {
  const auto write = [&](std::span<const std::byte> bytes) {
    to.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  const auto length = little_endian<kLengthBytes>(record.size());
  write(length);
  write(little_endian<kCheckBytes>(masked_crc32c(length)));
  write(record);
  write(little_endian<kCheckBytes>(masked_crc32c(record)));
}

TfRecordReader::TfRecordReader(std::vector<fs::path> files, std::size_t most_bytes)
    : files_(std::move(files)), most_bytes_(most_bytes) {}

TfRecordReader::~TfRecordReader() = default;

std::optional<TfRecord> TfRecordReader::next() {
  while (true) {
    if (file_) {
      if (auto record = file_->next()) return record;
      file_.reset();
    }
    if (opened_ == files_.size()) return std::nullopt;
    file_ = std::make_unique<File>(files_[opened_++], most_bytes_);
  }
}

}  // namespace vkopple
