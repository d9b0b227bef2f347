// Row-major matrices, read and written in fours of a row (or column) of `count` elements.

// Elements number i … i + 3, the first at `at` and the others `step` apart; zeros from number `count` on and where `inside` is false.
#define singles4(name, inside, at, step, i, count) \
  vec4(load1_or_zero(name, (inside) && (i) < (count), at), \
       load1_or_zero(name, (inside) && (i) + 1 < (count), (at) + (step)), \
       load1_or_zero(name, (inside) && (i) + 2 < (count), (at) + 2 * (step)), \
       load1_or_zero(name, (inside) && (i) + 3 < (count), (at) + 3 * (step)))

// Writes or adds elements i … i + 3 of a row that starts at `at`, as far as they exist. The operand has two bindings, name4 and name1:
// vectors where `vectors` says that rows start at multiples of 4, else single elements; the other one is not used.
#define add_row4(name, vectors, at, i, count, v, accumulate) \
  { \
    vec4 row_ = v; \
    if ((vectors) != 0) \
      add4(name##4, ((at) + (i)) >> 2, row_, accumulate) \
    else \
      for (uint j_ = 0; j_ < min(4u, (count) - (i)); ++j_) add1(name##1, (at) + (i) + j_, row_[j_], accumulate) \
  }
