#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace vkopple {

/// A column for every row, none twice, so that the costs add up to as little as possible (the Hungarian
/// algorithm, in time rows² × columns). costs: (rows, columns), row by row, finite. Throws Error where columns
/// are fewer than rows.
std::vector<size_t> cheapest_assignment(std::span<const double> costs, size_t rows, size_t columns);

}  // namespace vkopple
