// What the rounded product of two numbers lacks: a · b = product + product_remainder(a, b, product), exactly while nothing over-
// or underflows.
//
// A fused multiply-add gives it at once, but Vulkan lets devices round the product within fma(), which leaves nothing; where they do
// (runtime/quirks.h), halves of 12 bits are multiplied, whose products are exact (Dekker).
layout(constant_id = 104) const bool kFusedProducts = true;

#define PRODUCT_REMAINDER(type)                                                                                \
  type product_remainder(type a, type b, type product) {                                                      \
    if (kFusedProducts) return fma(a, b, -product);                                                            \
    precise type spread_a = 4097.0 * a, high_a = spread_a - (spread_a - a), low_a = a - high_a;                \
    precise type spread_b = 4097.0 * b, high_b = spread_b - (spread_b - b), low_b = b - high_b;                \
    precise type rest = ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b;       \
    return rest;                                                                                               \
  }
PRODUCT_REMAINDER(float)
PRODUCT_REMAINDER(vec4)
