#include "models/identities.h"

#include <algorithm>

#include "models/assignment.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// g of the header.
double likeness(std::span<const float> a, std::span<const float> b) {
  double length_a = 0, length_b = 0, distance = 0;  // all squared
  for (size_t i = 0; i < a.size(); ++i) {
    const double x = a[i], y = b[i];
    length_a += x * x;
    length_b += y * y;
    distance += (x - y) * (x - y);
  }
  return std::min(length_a, length_b) - distance;
}

}  // namespace

std::vector<std::optional<size_t>> Identities::match(const std::vector<Code>& codes) const {
  // After the identities a column of "new" for each code.
  const size_t columns = last_.size() + codes.size();
  std::vector<double> costs;
  costs.reserve(codes.size() * columns);
  for (const Code& code : codes) {
    for (const Code& last : last_) costs.push_back(-likeness(code, last));
    costs.insert(costs.end(), codes.size(), 0);
  }
  std::vector<std::optional<size_t>> identities;
  for (const size_t column : cheapest_assignment(costs, codes.size(), columns))
    identities.push_back(column < last_.size() ? std::optional(column) : std::nullopt);
  return identities;
}

std::vector<std::optional<size_t>> Identities::follow(std::span<const float> codes,
                                                      const std::vector<bool>& visible) {
  if (codes.size() != visible.size() * numbers_) throw Error("identity codes and slots differ in number");
  std::vector<size_t> slots;
  std::vector<Code> shown;
  for (size_t k = 0; k < visible.size(); ++k) {
    if (!visible[k]) continue;
    const auto code = codes.subspan(k * numbers_, numbers_);
    slots.push_back(k);
    shown.emplace_back(code.begin(), code.end());
  }
  const auto matched = match(shown);
  std::vector<std::optional<size_t>> identities(visible.size());
  for (size_t i = 0; i < shown.size(); ++i) {
    const size_t identity = matched[i].value_or(last_.size());
    if (!matched[i]) last_.emplace_back();
    last_[identity] = std::move(shown[i]);
    identities[slots[i]] = identity;
  }
  return identities;
}

}  // namespace vkopple
