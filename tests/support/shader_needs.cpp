#include "tests/support/shader_needs.h"

#include <fmt/format.h>

#include "runtime/error.h"

namespace vkopple::test {
namespace {

// SPIR-V specification, section 3.
enum Opcode : uint32_t {
  kCapability = 17,
  kTypeBool = 20,
  kTypeInt = 21,
  kTypeFloat = 22,
  kTypeVector = 23,
  kTypeArray = 28,
  kTypeStruct = 30,
  kTypePointer = 32,
  kConstantTrue = 41,
  kConstantFalse = 42,
  kConstant = 43,
  kConstantComposite = 44,
  kSpecConstantTrue = 48,
  kSpecConstantFalse = 49,
  kSpecConstant = 50,
  kSpecConstantComposite = 51,
  kSpecConstantOp = 52,
  kVariable = 59,
  kDecorate = 71,
  kCompositeExtract = 81,
  kIAdd = 128,
  kISub = 130,
  kIMul = 132,
  kUDiv = 134,
  kSDiv = 135,
  kUMod = 137,
  kLogicalOr = 166,
  kLogicalAnd = 167,
  kLogicalNot = 168,
  kSelect = 169,
  kIEqual = 170,
  kINotEqual = 171,
  kUGreaterThan = 172,
  kSGreaterThan = 173,
  kUGreaterThanEqual = 174,
  kSGreaterThanEqual = 175,
  kULessThan = 176,
  kSLessThan = 177,
  kULessThanEqual = 178,
  kSLessThanEqual = 179,
  kShiftRightLogical = 194,
  kShiftLeftLogical = 196,
  kBitwiseOr = 197,
  kBitwiseAnd = 199,
};
constexpr size_t kHeaderWords = 5;
constexpr uint32_t kWorkgroup = 4;
constexpr uint32_t kSpecId = 1;

class Module {
 public:
  Module(const ShaderCode& shader, const std::map<uint32_t, uint32_t>& constants)
      : shader_(shader), constants_(constants) {
    const auto code = shader.code;
    for (size_t at = kHeaderWords; at < code.size(); at += code[at] >> 16)
      learn(code.subspan(at, code[at] >> 16));
  }

  ShaderNeeds needs() const {
    ShaderNeeds needs{.capabilities = capabilities_};
    for (const uint32_t pointer : shared_) needs.shared_bytes += bytes(made(pointer)[3]);
    return needs;
  }

 private:
  using Words = std::span<const uint32_t>;

  void learn(Words words) {
    switch (words[0] & 0xffff) {
      case kCapability:
        capabilities_.insert(words[1]);
        break;
      case kDecorate:
        if (words[2] == kSpecId) spec_ids_[words[1]] = words[3];
        break;
      case kVariable:
        if (words[3] == kWorkgroup) shared_.push_back(words[1]);
        break;
      case kTypeBool:
      case kTypeInt:
      case kTypeFloat:
      case kTypeVector:
      case kTypeArray:
      case kTypeStruct:
      case kTypePointer:
        made_[words[1]] = words;
        break;
      case kConstantTrue:
      case kConstantFalse:
      case kConstant:
      case kConstantComposite:
      case kSpecConstantTrue:
      case kSpecConstantFalse:
      case kSpecConstant:
      case kSpecConstantComposite:
      case kSpecConstantOp:
        made_[words[2]] = words;
        break;
      default:
        break;
    }
  }

  uint64_t bytes(uint32_t type) const {
    const Words words = made(type);
    switch (words[0] & 0xffff) {
      case kTypeBool:
        return 4;
      case kTypeInt:
      case kTypeFloat:
        return words[2] / 8;
      case kTypeVector:
        return bytes(words[2]) * (words[3] == 3 ? 4 : words[3]);
      case kTypeArray:
        return bytes(words[2]) * value(words[3]);
      case kTypeStruct: {
        uint64_t sum = 0;
        for (const uint32_t member : words.subspan(2)) sum += bytes(member);
        return sum;
      }
      default:
        throw Error(fmt::format("shader {}: a type of shared memory is unknown", shader_.name));
    }
  }

  Words made(uint32_t id) const {
    const auto found = made_.find(id);
    if (found == made_.end())
      throw Error(
          fmt::format("shader {}: the size of shared memory depends on what is no constant", shader_.name));
    return found->second;
  }

  uint32_t value(uint32_t id) const {
    const Words words = made(id);
    const uint32_t opcode = words[0] & 0xffff;
    if (const auto spec = spec_ids_.find(id); spec != spec_ids_.end())
      if (const auto given = constants_.find(spec->second); given != constants_.end()) return given->second;
    if (opcode == kConstantTrue || opcode == kSpecConstantTrue) return 1;
    if (opcode == kConstantFalse || opcode == kSpecConstantFalse) return 0;
    if (opcode == kConstant || opcode == kSpecConstant) return words[3];
    return result(words[3], words.subspan(4));
  }

  /// ids: operands, of which the second is a plain number where a part of a composite is taken.
  uint32_t result(uint32_t opcode, Words ids) const {
    if (opcode == kCompositeExtract) return value(made(ids[0])[3 + ids[1]]);
    const uint32_t a = value(ids[0]);
    if (opcode == kLogicalNot) return a == 0 ? 1 : 0;
    if (opcode == kSelect) return value(ids[a != 0 ? 1 : 2]);
    const uint32_t b = value(ids[1]);
    const auto sa = static_cast<int32_t>(a);
    const auto sb = static_cast<int32_t>(b);
    switch (opcode) {
      case kIAdd:
        return a + b;
      case kISub:
        return a - b;
      case kIMul:
        return a * b;
      case kUDiv:
        return a / b;
      case kSDiv:
        return static_cast<uint32_t>(sa / sb);
      case kUMod:
        return a % b;
      case kLogicalOr:
        return (a != 0 || b != 0) ? 1 : 0;
      case kLogicalAnd:
        return (a != 0 && b != 0) ? 1 : 0;
      case kIEqual:
        return a == b ? 1 : 0;
      case kINotEqual:
        return a != b ? 1 : 0;
      case kUGreaterThan:
        return a > b ? 1 : 0;
      case kSGreaterThan:
        return sa > sb ? 1 : 0;
      case kUGreaterThanEqual:
        return a >= b ? 1 : 0;
      case kSGreaterThanEqual:
        return sa >= sb ? 1 : 0;
      case kULessThan:
        return a < b ? 1 : 0;
      case kSLessThan:
        return sa < sb ? 1 : 0;
      case kULessThanEqual:
        return a <= b ? 1 : 0;
      case kSLessThanEqual:
        return sa <= sb ? 1 : 0;
      case kShiftRightLogical:
        return a >> b;
      case kShiftLeftLogical:
        return a << b;
      case kBitwiseOr:
        return a | b;
      case kBitwiseAnd:
        return a & b;
      default:
        throw Error(fmt::format("shader {}: operation {} of specialization constants is unknown", shader_.name,
                                opcode));
    }
  }

  const ShaderCode& shader_;
  const std::map<uint32_t, uint32_t>& constants_;
  std::set<uint32_t> capabilities_;
  std::map<uint32_t, Words> made_;         ///< by id: the instructions of types and constants
  std::map<uint32_t, uint32_t> spec_ids_;  ///< by id
  std::vector<uint32_t> shared_;           ///< pointer types of variables
};

}  // namespace

ShaderNeeds shader_needs(const ShaderCode& shader, const std::map<uint32_t, uint32_t>& constants) {
  return Module(shader, constants).needs();
}

}  // namespace vkopple::test
