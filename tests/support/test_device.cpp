#include "tests/support/test_device.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string_view>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// Mesa since version 25 says this of every samplerBuffer. It is so from SPIR-V 1.6 on; Vulkan 1.1's is 1.3.
constexpr std::string_view kOfLaterVersions =
    "Image Type operand of OpTypeSampledImage should not have a Dim of Buffer";

}  // namespace

void fail_test(const std::string& message) {
  if (message.find(kOfLaterVersions) == std::string::npos) ADD_FAILURE() << "validation: " << message;
}

// Maps of devices are made after test_device(), and so destroyed before it, and before the layers' own static
// objects, which the first device brings.

const Device& test_device() {
  static const Device device({.selector = "", .on_message = fail_test, .access = {}, .cache_folder = {}});
  return device;
}

const Device& exact_device() {
  static const Device device({.selector = "", .on_message = fail_test, .exact_sums = true});
  return device;
}

const Device* family_device(KernelFamily family, bool exact_sums) {
  if (!missing_for(family, test_device().caps()).empty()) return nullptr;
  static std::map<std::pair<KernelFamily, bool>, std::unique_ptr<Device>> devices;
  auto& device = devices[{family, exact_sums}];
  if (!device)
    device = std::make_unique<Device>(DeviceOptions{.selector = "",
                                                    .on_message = fail_test,
                                                    .exact_sums = exact_sums,
                                                    .winograd = WinogradUse::kNever,
                                                    .kernels = family,
                                                    .cache_folder = {}});
  return device.get();
}

const Device& long_work_device() {
  static const Device device({.selector = "", .on_message = fail_test, .long_work = true, .cache_folder = {}});
  return device;
}

const Device* plain_stores_device() {
  static const auto device = []() -> std::unique_ptr<Device> {
    if (!test_device().caps().row_stores) return nullptr;
    return std::make_unique<Device>(
        DeviceOptions{.selector = "", .on_message = fail_test, .row_stores = false, .cache_folder = {}});
  }();
  return device.get();
}

const Device* winograd_device(WinogradUse use) {
  if (!missing_for(use, test_device().caps()).empty()) return nullptr;
  static std::map<WinogradUse, std::unique_ptr<Device>> devices;
  auto& device = devices[use];
  if (!device)
    device = std::make_unique<Device>(
        DeviceOptions{.selector = "", .on_message = fail_test, .winograd = use, .cache_folder = {}});
  return device.get();
}

const Device* other_access_device(KernelFamily family) {
  const Caps& caps = test_device().caps();
  const bool texel = caps.access == AccessPath::kTexel;
  const AccessPath other = texel ? AccessPath::kStorage : AccessPath::kTexel;
  if (!missing_for(other, caps).empty() || !missing_for(family, caps).empty()) return nullptr;
  static std::map<KernelFamily, std::unique_ptr<Device>> devices;
  auto& device = devices[family];
  if (!device)
    device = std::make_unique<Device>(DeviceOptions{
        .selector = "", .on_message = fail_test, .access = other, .kernels = family, .cache_folder = {}});
  return device.get();
}

}  // namespace vkopple
