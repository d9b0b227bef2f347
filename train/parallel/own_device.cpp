#include "train/parallel/own_device.h"

#include <vector>

#include "runtime/instance.h"

namespace vkopple {

size_t choose_own_device(std::span<const Candidate> candidates, std::string_view selector, int process) {
  const size_t best = choose_device(candidates, selector);
  if (!selector.empty() && selector != "auto") return best;
  std::vector<size_t> alike;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].missing.empty() && candidates[i].caps.type == candidates[best].caps.type)
      alike.push_back(i);
  return alike[static_cast<size_t>(process) % alike.size()];
}

std::string own_device(const std::string& option, int process) {
  const Instance instance;
  return std::to_string(choose_own_device(instance.candidates(), device_selector(option), process));
}

}  // namespace vkopple
