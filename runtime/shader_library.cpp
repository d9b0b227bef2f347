#include "runtime/shader_library.h"

#include <fmt/format.h>

#include <map>
#include <string>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// The few instructions of SPIR-V that tell what a binding is and what the device needs (SPIR-V specification,
/// section 3.42).
struct Reflection {
  static constexpr uint32_t kOpName = 5;
  static constexpr uint32_t kOpCapability = 17;
  static constexpr uint32_t kOpTypePointer = 32;
  static constexpr uint32_t kOpVariable = 59;
  static constexpr uint32_t kOpDecorate = 71;
  static constexpr uint32_t kDecorationBinding = 33;
  static constexpr uint32_t kCooperativeMatrixKHR = 6022;
  static constexpr size_t kHeaderWords = 5;

  std::map<uint32_t, std::string> names;       ///< by id
  std::map<uint32_t, uint32_t> pointees;       ///< pointer type → type
  std::map<uint32_t, uint32_t> pointer_types;  ///< variable → pointer type
  std::map<uint32_t, uint32_t> variables;      ///< binding number → one of its variables
  bool cooperative = false;                    ///< declares the capability

  explicit Reflection(std::span<const uint32_t> code) {
    for (size_t at = kHeaderWords; at < code.size();) {
      const uint32_t words = code[at] >> 16;
      if (words == 0 || at + words > code.size()) throw Error("a shader's SPIR-V is damaged; build it again");
      visit(code[at] & 0xffff, code.subspan(at + 1, words - 1));
      at += words;
    }
  }

  void visit(uint32_t opcode, std::span<const uint32_t> operands) {
    if (opcode == kOpCapability && operands[0] == kCooperativeMatrixKHR) cooperative = true;
    if (opcode == kOpName) names[operands[0]] = reinterpret_cast<const char*>(operands.data() + 1);
    if (opcode == kOpTypePointer) pointees[operands[0]] = operands[2];
    if (opcode == kOpVariable) pointer_types[operands[1]] = operands[0];
    if (opcode == kOpDecorate && operands[1] == kDecorationBinding) variables[operands[2]] = operands[0];
  }

  /// The name of the variable, or of its block type where the block has no instance name.
  std::string name(uint32_t variable) const {
    if (const auto n = names.find(variable); n != names.end() && !n->second.empty()) return n->second;
    return names.at(pointees.at(pointer_types.at(variable)));
  }
};

}  // namespace

std::vector<BindingKind> binding_kinds(const ShaderCode& shader) {
  const Reflection reflection(shader.code);
  std::vector<BindingKind> kinds;
  for (const auto& [number, variable] : reflection.variables) {
    const std::string name = reflection.name(variable);
    if (number != kinds.size())
      throw Error(fmt::format("shader {}: binding {} is missing or unused", shader.name, kinds.size()));
    if (name.ends_with("_r4"))
      kinds.push_back(BindingKind::kRead4);
    else if (name.ends_with("_r1"))
      kinds.push_back(BindingKind::kRead1);
    else if (name.ends_with("_ru"))
      kinds.push_back(BindingKind::kReadU);
    else if (name.ends_with("_w4"))
      kinds.push_back(BindingKind::kWrite4);
    else if (name.ends_with("_w"))
      kinds.push_back(BindingKind::kWrite);
    else
      throw Error(fmt::format("shader {}: binding {} ({}) is not declared by a macro of access.glsl",
                              shader.name, number, name));
  }
  return kinds;
}

bool uses_cooperative_matrices(const ShaderCode& shader) { return Reflection(shader.code).cooperative; }

const ShaderCode& find_shader(std::string_view name, AccessPath access) {
  for (const auto& shader : shader_library())
    if (shader.name == name && shader.access == access) return shader;
  throw Error(fmt::format("there is no shader {}; the build embeds every file of shaders/", name));
}

}  // namespace vkopple
