#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "train/file_system.h"

namespace vkopple::test {

/// What FaultyFiles throws where a process would be no more. No Error: nothing catches it on the way.
struct Killed {};

/// Files of a system on which a call fails.
class FaultyFiles final : public FileSystem {
 public:
  enum class Fault {
    kNone,
    kFails,    ///< the call alone, with the error that was given
    kFull,     ///< the disk: half of that write is written, nothing from then on
    kKilled,   ///< Killed is thrown before the call is made; nothing that is asked later is done
    kSigkill,  ///< the process gets SIGKILL before the call is made
  };

  FaultyFiles() = default;
  /// The fault strikes call number `at`, counted from 0; with `only`, of the calls of that name. `error`: of
  /// kFails.
  FaultyFiles(Fault fault, uint64_t at, int error = 0, std::string only = {})
      : fault_(fault), at_(at), error_(error), only_(std::move(only)) {}

  /// Names of the calls that were made.
  const std::vector<std::string>& calls() const { return calls_; }
  bool hit() const { return hit_; }

  FileDescriptor open(const char* path, int flags) override;
  ssize_t write(int file, const void* bytes, std::size_t count) override;
  int sync(int file) override;
  int close(FileDescriptor& file) override;
  int rename(const char* from, const char* to) override;
  int unlink(const char* path) override;

 private:
  /// Notes a call; whether it is to fail, errno being set.
  bool fails(const char* call);

  Fault fault_ = Fault::kNone;
  uint64_t at_ = 0;
  int error_ = 0;
  std::string only_;
  uint64_t counted_ = 0;  ///< calls that `at_` counts
  std::vector<std::string> calls_;
  bool hit_ = false;
  bool full_ = false;  ///< the last bytes are written
};

}  // namespace vkopple::test
