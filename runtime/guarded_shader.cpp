#include "runtime/guarded_shader.h"

#include <fmt/format.h>

#include <map>

#include "runtime/bounds.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

// SPIR-V specification, section 3.
constexpr size_t kHeaderWords = 5;
constexpr size_t kBoundWord = 3;
constexpr uint32_t kOpTypeInt = 21;
constexpr uint32_t kOpTypeStruct = 30;
constexpr uint32_t kOpTypePointer = 32;
constexpr uint32_t kOpConstant = 43;
constexpr uint32_t kOpFunction = 54;
constexpr uint32_t kOpVariable = 59;
constexpr uint32_t kOpAccessChain = 65;
constexpr uint32_t kOpInBoundsAccessChain = 66;
constexpr uint32_t kOpArrayLength = 68;
constexpr uint32_t kOpDecorate = 71;
constexpr uint32_t kOpIAdd = 128;
constexpr uint32_t kStorageBuffer = 12;
constexpr uint32_t kArrayStride = 6;

constexpr uint32_t instruction(uint32_t opcode, uint32_t words) { return words << 16 | opcode; }

/// Writes a module anew, instruction by instruction.
class Rewriter {
 public:
  explicit Rewriter(const ShaderCode& shader) : shader_(shader), next_id_(shader.code[kBoundWord]) {}

  std::vector<uint32_t> run() {
    each_instruction([&](std::span<const uint32_t> words) { learn(words); });
    out_.assign(shader_.code.begin(), shader_.code.begin() + kHeaderWords);
    bool declared = false;
    each_instruction([&](std::span<const uint32_t> words) {
      const uint32_t opcode = words[0] & 0xffff;
      if (opcode == kOpFunction && !declared) {
        declare_constants();
        declared = true;
      }
      if (opcode == kOpAccessChain || opcode == kOpInBoundsAccessChain)
        access(words);
      else
        out_.insert(out_.end(), words.begin(), words.end());
    });
    out_[kBoundWord] = next_id_;
    return std::move(out_);
  }

 private:
  template <class Visit>
  void each_instruction(Visit visit) const {
    const auto code = shader_.code;
    for (size_t at = kHeaderWords; at < code.size();) {
      const uint32_t words = code[at] >> 16;
      if (words == 0 || at + words > code.size()) throw Error("a shader's SPIR-V is damaged; build it again");
      visit(code.subspan(at, words));
      at += words;
    }
  }

  void learn(std::span<const uint32_t> words) {
    switch (words[0] & 0xffff) {
      case kOpDecorate:
        if (words[2] == kArrayStride) strides_[words[1]] = words[3];
        break;
      case kOpTypeInt:
        if (words[2] == 32 && words[3] == 0) uint_ = words[1];
        break;
      case kOpTypeStruct:
        if (words.size() == 3) only_members_[words[1]] = words[2];
        break;
      case kOpTypePointer:
        if (words[2] == kStorageBuffer) pointees_[words[1]] = words[3];
        break;
      case kOpVariable:
        if (words[3] == kStorageBuffer) add_buffer(words[2], words[1]);
        break;
      case kOpArrayLength:
        throw Error(fmt::format("shader {}: a guarded recording can't tell an array's length", shader_.name));
      default:
        break;
    }
  }

  void add_buffer(uint32_t variable, uint32_t pointer_type) {
    const auto member = only_members_.find(pointees_.at(pointer_type));
    const auto stride = member == only_members_.end() ? strides_.end() : strides_.find(member->second);
    if (stride == strides_.end() || kGuardBytes % stride->second != 0)
      throw Error(fmt::format("shader {}: a buffer is not declared by a macro of access.glsl", shader_.name));
    buffers_[variable] = stride->second;
    shifts_.try_emplace(stride->second, 0U);
  }

  void declare_constants() {
    if (shifts_.empty()) return;
    if (uint_ == 0) {
      uint_ = next_id_++;
      append({instruction(kOpTypeInt, 4), uint_, 32, 0});
    }
    for (auto& [stride, id] : shifts_) {
      id = next_id_++;
      append({instruction(kOpConstant, 4), uint_, id, static_cast<uint32_t>(kGuardBytes / stride)});
    }
  }

  /// words: opcode, type, result, base, member of the block, element, ... Integers may be added whatever their
  /// signs are.
  void access(std::span<const uint32_t> words) {
    const auto buffer = buffers_.find(words[3]);
    if (buffer == buffers_.end()) {
      out_.insert(out_.end(), words.begin(), words.end());
      return;
    }
    if (words.size() < 6)
      throw Error(fmt::format("shader {}: a buffer is not accessed element by element", shader_.name));
    const uint32_t element = next_id_++;
    append({instruction(kOpIAdd, 5), uint_, element, words[5], shifts_.at(buffer->second)});
    out_.insert(out_.end(), words.begin(), words.end());
    out_[out_.size() - words.size() + 5] = element;
  }

  void append(std::initializer_list<uint32_t> words) { out_.insert(out_.end(), words); }

  const ShaderCode& shader_;
  uint32_t next_id_;
  uint32_t uint_ = 0;                     ///< the type of unsigned integers of 32 bits; 0: none is declared
  std::map<uint32_t, uint32_t> strides_;  ///< of array types, bytes
  std::map<uint32_t, uint32_t> only_members_;  ///< struct type → type of its one member
  std::map<uint32_t, uint32_t> pointees_;      ///< pointer type to storage buffers → struct type
  std::map<uint32_t, uint32_t> buffers_;       ///< variable → bytes of an element
  std::map<uint32_t, uint32_t> shifts_;  ///< bytes of an element → constant that holds the elements of a band
  std::vector<uint32_t> out_;
};

}  // namespace

std::vector<uint32_t> guarded_code(const ShaderCode& shader) { return Rewriter(shader).run(); }

}  // namespace vkopple
