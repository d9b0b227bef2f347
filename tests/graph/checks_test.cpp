#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <string>

#include "graph/checks/check.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

class OpCheckTest : public testing::TestWithParam<OpChecks> {};

void run_all(const Device& device, const OpChecks& checks, Storage activations = Storage::kFloat32) {
  for (const CheckCase& check : checks.cases) {
    if (activations == Storage::kFloat16 && !has_activations(check)) continue;
    if (check.runs_on && !check.runs_on(device.caps())) {
      std::cout << "left out, " << device.caps().name << " has not what it takes: " << check.label << "\n";
      continue;
    }
    const CheckResult result = run_check(device, check, activations);
    for (const auto& failure : result.failures)
      ADD_FAILURE() << checks.op << " " << check.label << ": " << failure;
  }
}

TEST_P(OpCheckTest, MatchesItsReference) { run_all(test_device(), GetParam()); }

TEST_P(OpCheckTest, MatchesItsReferenceOnTheOtherAccessPath) {
  if (other_access_device() == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  run_all(*other_access_device(), GetParam());
}

TEST_P(OpCheckTest, MatchesItsReferenceInMixedPrecision) {
  run_all(test_device(), GetParam(), Storage::kFloat16);
}

TEST_P(OpCheckTest, MatchesItsReferenceInMixedPrecisionOnTheOtherAccessPath) {
  if (other_access_device() == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  run_all(*other_access_device(), GetParam(), Storage::kFloat16);
}

TEST(RowStoresTest, KernelsMatchTheirReferencesWithoutThem) {
  if (plain_stores_device() == nullptr) GTEST_SKIP() << "the device stores no rows: all tests ran without";
  for (const OpChecks& checks : all_checks())
    for (const std::string_view op :
         {"conv2d", "conv_transpose2d", "batch_norm", "layer_norm", "leaky_relu", "binary", "slice", "concat"})
      if (checks.op == op) run_all(*plain_stores_device(), checks);
}

TEST(ExactSumsTest, ConvolutionsMatchTheirReferences) {
  for (const OpChecks& checks : all_checks())
    if (checks.op.starts_with("conv")) run_all(exact_device(), checks);
}

/// What has kernels of several families, with each: an op's weight gradient follows Caps alone.
class KernelFamilyTest : public testing::TestWithParam<KernelFamily> {};

void run_family(const Device& device, KernelFamily family) {
  for (OpChecks checks : all_checks()) {
    if (!checks.op.starts_with("conv") && checks.op != "linear" && checks.op != "lstm") continue;
    // Products may be forced to a kernel by the case: those of other families run elsewhere.
    std::erase_if(checks.cases, [&](const CheckCase& c) {
      const auto forced = [&](std::string_view name) { return c.label.ends_with(name); };
      return forced(" winograd2") || forced(" winograd4") ||
             (family != KernelFamily::kRegisters && forced(" shuffle")) ||
             (family != KernelFamily::kShared && family != KernelFamily::kCooperative && forced(" shared")) ||
             (family != KernelFamily::kPlain && forced(" uniform"));
    });
    run_all(device, checks);
    // Rounding weights to float16 as well as results stays within the limits for results alone: neither adds to
    // an error by more than 1 / sqrt(3) of a unit round-off, root mean square.
    if (family == KernelFamily::kCooperative) run_all(device, checks, Storage::kFloat16);
  }
}

TEST_P(KernelFamilyTest, ConvolutionsAndProductsMatchTheirReferences) {
  const Device* device = family_device(GetParam());
  if (device == nullptr) GTEST_SKIP() << missing_for(GetParam(), test_device().caps());
  run_family(*device, GetParam());
}

// GPUs read storage buffers.
TEST(SharedFamilyTest, MatchesItsReferencesOnTheOtherAccessPath) {
  const Device* device = other_access_device(KernelFamily::kShared);
  if (device == nullptr) GTEST_SKIP() << missing_for(AccessPath::kTexel, test_device().caps());
  run_family(*device, KernelFamily::kShared);
}

INSTANTIATE_TEST_SUITE_P(Families, KernelFamilyTest,
                         testing::Values(KernelFamily::kRegisters, KernelFamily::kShared,
                                         KernelFamily::kCooperative, KernelFamily::kPlain));

std::string test_name(const testing::TestParamInfo<OpChecks>& test) { return std::string(test.param.op); }

INSTANTIATE_TEST_SUITE_P(Ops, OpCheckTest, testing::ValuesIn(all_checks()), test_name);

TEST(OpChecksTest, EveryOpHasOne) {
  const auto checks = all_checks();
  for (std::string_view op : all_ops()) {
    const auto found =
        std::find_if(checks.begin(), checks.end(), [&](const OpChecks& c) { return c.op == op; });
    ASSERT_NE(found, checks.end()) << op << " has no check: add graph/checks/" << op << ".cpp";
    EXPECT_FALSE(found->cases.empty()) << op << " has a check without cases";
  }
}

}  // namespace
}  // namespace vkopple
