#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace vkopple {

/// Which object is which over the frames of a recording, told by identity codes (docs/model.md §3).
///
/// The identities are all objects seen so far, each with its code c_l in the last frame that shows it, however
/// long ago that was. A slot with code c_k speaks for identity l by
///
///   g_kl = min(‖c_k‖², ‖c_l‖²) − ‖c_k − c_l‖²,
///
/// the logarithm of how much likelier §3's r is to match the two than either with the background, whose code is
/// zero, from the frame on where that is less. Slots get identities, none twice, so that the sum of g is
/// largest, and none where g would be negative: these are new objects.
class Identities {
 public:
  /// `numbers`: of an identity code.
  explicit Identities(size_t numbers) : numbers_(numbers) {}

  /// Identities of a frame's slots, counted from 0; none of a slot that shows nothing (`visible`, of K).
  /// codes: (K, numbers). Throws Error on another count.
  std::vector<std::optional<size_t>> follow(std::span<const float> codes, const std::vector<bool>& visible);

 private:
  using Code = std::vector<float>;

  /// Identities of the codes; none where they are new.
  std::vector<std::optional<size_t>> match(const std::vector<Code>& codes) const;

  size_t numbers_;
  std::vector<Code> last_;  ///< by identity
};

}  // namespace vkopple
