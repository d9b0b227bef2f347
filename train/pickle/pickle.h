#pragma once

#include <cstddef>
#include <set>
#include <span>
#include <string>

#include "train/pickle/pickle_value.h"
#include "train/pickle/pickle_view.h"

namespace vkopple {

/// What a pickle may ask of us before it is refused.
struct PickleLimits {
  std::size_t max_depth = 64;  ///< nesting of containers
  /// Pushed in all, and what builtins copy. Each takes 16 bytes where it is held; a string, bytes or a
  /// container some 50 more and its content.
  std::size_t max_values = 100'000'000;
};

/// A pickle of Python (protocols 0 to 5), read without executing anything.
///
/// Plain data are read as they are: None, truth values, whole numbers of up to 64 bits, numbers, strings,
/// bytes, tuples, lists, dicts, sets, OrderedDicts. Of other globals ("module.name") only those of `allowed`
/// are taken; what the pickle would call of them stays a call with its arguments (PickleKind::kCall) for the
/// caller to understand. Persistent ids likewise. Anything else is an Error that names it and its place in the
/// bytes.
class Pickle {
 public:
  Pickle(std::span<const std::byte> bytes, const std::string& source, const std::set<std::string>& allowed = {},
         const PickleLimits& limits = {});
  Pickle(const Pickle&) = delete;
  Pickle& operator=(const Pickle&) = delete;

  const PickleValue& root() const { return root_; }
  /// The root with its place, for reading what has a known form. Must not outlive this.
  PickleView view() const { return {root_, source_}; }

 private:
  std::string source_;
  PickleArena arena_;
  PickleValue root_;
};

}  // namespace vkopple
