#include "models/assignment.h"

#include <limits>
#include <optional>

#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Costs with a price for every row and column taken off, so that none is negative and that of every assigned
/// pair is zero. Rows are assigned one after another, each along the cheapest path to a column that is free.
class Assignment {
 public:
  Assignment(std::span<const double> costs, size_t rows, size_t columns)
      : costs_(costs), columns_(columns), row_price_(rows, 0), column_price_(columns, 0), row_of_(columns) {}

  void assign(size_t row) {
    std::vector<double> distance(columns_, kUnreached);
    std::vector<std::optional<size_t>> before(columns_);  // the column of the path before this; none: its start
    std::vector<bool> done(columns_, false);
    std::vector<size_t> path_columns;
    std::optional<size_t> column;
    double reached = 0;
    for (size_t from = row;; from = *row_of_[*column]) {
      std::optional<size_t> next;
      for (size_t c = 0; c < columns_; ++c) {
        if (done[c]) continue;
        const double through = reached + reduced(from, c);
        if (through < distance[c]) {
          distance[c] = through;
          before[c] = column;
        }
        if (!next || distance[c] < distance[*next]) next = c;
      }
      column = next;
      reached = distance[*column];
      done[*column] = true;
      if (!row_of_[*column]) break;
      path_columns.push_back(*column);
    }
    row_price_[row] += reached;
    for (const size_t c : path_columns) {
      row_price_[*row_of_[c]] += reached - distance[c];
      column_price_[c] -= reached - distance[c];
    }
    for (; before[*column]; column = before[*column]) row_of_[*column] = row_of_[*before[*column]];
    row_of_[*column] = row;
  }

  std::vector<size_t> columns_of_rows() const {
    std::vector<size_t> columns(row_price_.size());
    for (size_t c = 0; c < columns_; ++c)
      if (row_of_[c]) columns[*row_of_[c]] = c;
    return columns;
  }

 private:
  double reduced(size_t row, size_t column) const {
    return costs_[row * columns_ + column] - row_price_[row] - column_price_[column];
  }

  std::span<const double> costs_;
  size_t columns_;
  std::vector<double> row_price_, column_price_;
  std::vector<std::optional<size_t>> row_of_;
};

}  // namespace

std::vector<size_t> cheapest_assignment(std::span<const double> costs, size_t rows, size_t columns) {
  if (columns < rows) throw Error("an assignment needs at least as many columns as rows");
  if (costs.size() != rows * columns) throw Error("an assignment needs a cost for every row and column");
  Assignment assignment(costs, rows, columns);
  for (size_t row = 0; row < rows; ++row) assignment.assign(row);
  return assignment.columns_of_rows();
}

}  // namespace vkopple
