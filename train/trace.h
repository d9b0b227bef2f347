#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "graph/profile.h"
#include "runtime/caps.h"

namespace vkopple {

/// A time line in the format of chrome://tracing and Perfetto (JSON of "complete" events): what the host did,
/// the passes on the device, every op of them and every dispatch, fill and copy of every op.
///
/// A device's clock is its own. A pass is placed so that it ends when the host saw its end.
class Trace {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Trace(const Caps& caps);

  /// A piece of host work; those that lie within another are drawn below it.
  void add_host(const std::string& name, Clock::time_point begin, Clock::time_point end);
  /// Submission and waiting, and what the device did.
  void add_pass(const PassProfile& pass);

  bool empty() const { return events_.empty(); }
  /// The document.
  std::string text() const;
  /// Writes it through AtomicFile. Throws Error.
  void write(const std::filesystem::path& path) const;

  /// Adds a piece of host work from its making to its end. Nothing without a trace.
  class Span {
   public:
    Span(Trace* trace, std::string name) : trace_(trace), name_(std::move(name)), begin_(Clock::now()) {}
    ~Span() {
      if (trace_ != nullptr) trace_->add_host(name_, begin_, Clock::now());
    }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

   private:
    Trace* trace_;
    std::string name_;
    Clock::time_point begin_;
  };

 private:
  enum class Row { kHost = 1, kPasses = 2, kOps = 3 };
  /// A piece of time in nanoseconds, so that what lies within another still does when written.
  struct Event {
    Row row;
    int64_t begin, end;
    std::string text;  ///< JSON of name, category and arguments
  };
  void add_node(const NodeProfile& node, const std::string& pass, int64_t device_start);

  Caps caps_;
  std::vector<Event> events_;
};

}  // namespace vkopple
