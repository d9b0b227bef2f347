#include "train/pickle/pickle.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/formats/authors/authors_table.h"
#include "train/pickle/numpy_array.h"

namespace vkopple::fuzz {
namespace {

constexpr std::size_t kMostVisits = 10'000;  // values that are shared are met again and again

void visit(const PickleView& view, std::size_t& visits) {
  if (++visits > kMostVisits) return;
  numpy_array(view.value());
  tolerate([&] { view.integer(INT64_MIN, INT64_MAX); });
  tolerate([&] { view.numbers({3}); });
  tolerate([&] { view.contains("frame1"); });
  tolerate([&] {
    for (std::size_t i = 0; i < view.size(); ++i) visit(view[i], visits);
  });
}

}  // namespace

void pickle(Input input) {
  tolerate([&] {
    const Pickle read(input, "input", numpy_globals());
    std::size_t visits = 0;
    visit(read.view(), visits);
  });
  const InputFile file(input);
  authors_table_pickle(read_authors_table(file.path()));
}

}  // namespace vkopple::fuzz
