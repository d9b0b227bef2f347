#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace vkopple {

/// Writes a pickle of protocol 2, which every Python since 2.3 reads, from front to back. What fills a
/// container is a function that writes its values.
class PickleWriter {
 public:
  PickleWriter();

  void text(std::string_view utf8);
  void whole(std::int64_t value);
  void number(double value);
  void truth(bool value);
  /// A function or class.
  void global(std::string_view module, std::string_view name);

  template <class Fill>
  void list(const Fill& fill) {
    raw("](");
    fill();
    raw("e");
  }
  template <class Fill>
  void tuple(const Fill& fill) {
    raw("(");
    fill();
    raw("t");
  }
  void empty_tuple() { raw(")"); }
  /// Fill gives keys and values by turns.
  template <class Fill>
  void dict(const Fill& fill) {
    raw("}");
    entries(fill);
  }
  /// Adds to the dict that was written last.
  template <class Fill>
  void entries(const Fill& fill) {
    raw("(");
    fill();
    raw("u");
  }

  /// Python calls the global before last with the tuple written last.
  void call() { raw("R"); }
  /// What was written last becomes the name of something that is kept elsewhere.
  void persistent() { raw("Q"); }

  /// The pickle of the one value that was written; nothing may follow.
  std::string finish();

 private:
  void raw(std::string_view instructions) { bytes_ += instructions; }
  void little(std::uint64_t number, int bytes);

  std::string bytes_;
};

}  // namespace vkopple
