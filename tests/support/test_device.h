#pragma once

#include <string>
#include <vector>

#include "runtime/device.h"

namespace vkopple {

/// Fails the test that runs, unless the message is one that says nothing about this project:
/// DeviceOptions::on_message of tests' devices.
void fail_test(const std::string& message);

/// The device that tests share (VKOPPLE_DEVICE chooses it), with the validation layer loaded. Every message of
/// the layer fails the test that runs at that moment.
const Device& test_device();
/// The same device with convolutions that keep what their sums round off.
const Device& exact_device();
/// The same device made to run one family of kernels, without Winograd's algorithm, with plain or exact
/// sums; null where it can't.
const Device* family_device(KernelFamily family, bool exact_sums = false);
/// The same device made to store lane by lane where it would store rows (Caps::row_stores); null where it does
/// anyway.
const Device* plain_stores_device();
/// The same device set up for work that goes on for long (Caps::long_work), as training does.
const Device& long_work_device();
/// The same device whose convolutions are made to use Winograd's algorithm wherever it can run; null where it
/// can't anywhere.
const Device* winograd_device(WinogradUse use);
/// The same device with the other access path; null where it can't have it, or can't run the family.
const Device* other_access_device(KernelFamily family = KernelFamily::kAuto);

}  // namespace vkopple
